"""What is said of objects that no category fits: their parts, what they afford, and how sure that is."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from kb.percept import PerceivedObject
from kb.references import load_references
from kb.vocabulary import UNKNOWN_CATEGORY
from sim.draw_scene import draw_scene
from sim.ood_catalogue import any_model
from sim.robot import Robot
from sim.scene_file import load_scene
from sim.world import World
from tools.execute_grasp import trial_lift_cap
from tools.perceive import PerceiveArgs
from tools.perception import rgbd_perceiver
from tools.perception.rgbd_perceiver import RgbdPerceiver
from tools.planning.force_choice import first_force, force_cap
from tools.planning.rim_candidates import rim_candidates


@cache
def seen(model: str, seed: int = 11_000) -> PerceivedObject:
    """The one object on the table, as the cameras show it."""
    world = World(draw_scene(load_scene(f"ood_{model}"), seed))
    views = Robot(world).look(np.random.default_rng(seed))
    percept = RgbdPerceiver(references=load_references()).perceive(views, PerceiveArgs())
    assert len(percept.objects) == 1, [item.category for item in percept.objects]
    return percept.objects[0]


@pytest.mark.parametrize(
    ("model", "kind", "region"),
    [
        ("teapot", "GRASPABLE_HANDLE", "handle"),
        ("watering_can", "GRASPABLE_HANDLE", "handle"),
        ("hammer", "TOOL_HANDLE", "handle"),
        ("dinner_plate", "GRASPABLE_EDGE", "rim"),
        ("egg", "WRAPPABLE", "body"),
        ("tv_remote", "CLAMPABLE", "edge"),
        ("paperback", "CLAMPABLE", "edge"),
        ("clothes_peg", "PINCHABLE", "body"),
        ("soup_can", "GRASPABLE_BODY", "body"),
    ],
)
def test_affordance_follows_from_geometry_and_appearance(model: str, kind: str, region: str) -> None:
    """An object of no known category gets the type and region of the table from what is seen of it, as one object."""
    thing = seen(model)
    assert thing.category == UNKNOWN_CATEGORY
    assert (thing.affordance.type, thing.affordance.region) == (kind, region)
    assert 0.0 < thing.affordance_confidence < 1.0


@pytest.mark.parametrize(("model", "region"), [("teapot", "handle"), ("watering_can", "handle"), ("hammer", "handle")])
def test_handles_are_measured(model: str, region: str) -> None:
    """A protruding loop or a slim end is found as wide as it is, within 3 mm."""
    part = seen(model).part(region)  # pyright: ignore[reportArgumentType]
    true = next(part for part in any_model(model).form().parts if part.region == region)
    assert part is not None
    assert part.width == pytest.approx(true.width, abs=0.003)


def test_fragility_is_an_interval_and_the_first_force_bears_its_upper_end() -> None:
    """What is round may be an egg: the fingers close with what an egg bears; a test lift may raise it, but not above
    what the middle of the interval bears."""
    egg = seen("egg")
    assert egg.fragility_range is not None
    low, high = egg.fragility_range
    assert low < any_model("egg").affordance.fragility < high
    first, most = first_force(egg), trial_lift_cap(egg)
    assert first is not None
    assert most is not None
    assert first <= max(4.0, force_cap(high)) < most


def test_what_is_known_has_no_interval() -> None:
    """Of a known category the descriptor and the weight are known; no test lift takes place."""
    apple = seen("apple")
    assert apple.category == "apple"
    assert apple.fragility_range is None
    assert first_force(apple) is None
    assert trial_lift_cap(apple) is None


@pytest.mark.parametrize("seed", [13_000, 13_004])
def test_a_loop_behind_the_body_is_told_from_the_spout_in_front(seed: int) -> None:
    """The front camera sees the can's spout well and its loop not at all; the handle is the loop, and as tall as one."""
    handle = seen("watering_can", seed).part("handle")
    assert handle is not None
    assert handle.outward is not None
    assert handle.outward[0] < -0.9
    assert handle.length == pytest.approx(0.085, abs=0.012)


def test_a_stub_is_no_handle() -> None:
    """A lying bulb is a round body from which its base sticks out; it is taken by its body, as gently as an egg."""
    bulb = seen("light_bulb", 13_001)
    assert bulb.part("handle") is None
    assert bulb.affordance.type == "WRAPPABLE"


def test_a_grip_on_a_loop_is_not_raised() -> None:
    """What hangs by a loop may turn; the test lift presses harder on a body only."""
    pot = seen("teapot")
    assert trial_lift_cap(pot, "handle") is None
    assert trial_lift_cap(pot, "body") is not None


@pytest.mark.parametrize(("model", "seed"), [("hammer", 13_002), ("kitchen_knife", 13_007), ("paperback", 13_002)])
def test_pieces_on_one_axis_are_one_thing(model: str, seed: int) -> None:
    """A head across its handle, a blade's root and the top of a book's pages: `seen` asserts that there is one object."""
    assert seen(model, seed).category == UNKNOWN_CATEGORY


def test_the_hand_leans_with_the_wall_of_a_plate() -> None:
    """A plate's wall lies nearly flat; its grips lean by 40 degrees, a bowl's by 25 at most."""
    plate, bowl = seen("dinner_plate"), seen("rice_bowl")
    tilts = [
        max(item.tilt for item in rim_candidates(thing, rim, "rim"))
        for thing in (plate, bowl)
        if (rim := thing.part("rim")) is not None
    ]
    assert np.degrees(tilts) == pytest.approx([40.0, 25.0], abs=0.5)


@pytest.mark.parametrize("seed", [14_106, 14_109, 14_112])
def test_a_foot_apart_from_its_body_is_no_thing_of_its_own(seed: int) -> None:
    """A plush animal of which the pictures show one foot apart is one object, as high as it sits."""
    assert seen("plush_toy", seed).size[2] > 0.08


def test_what_has_a_stem_is_held_with_what_the_weakest_glass_bears() -> None:
    """Fingers close on an unknown stem below three quarters of the least damage force of glass, 4 N, and never press more
    than that, while what is transparent and has no stem may weigh more and be gripped harder."""
    flute, jar = seen("champagne_flute", 14_120), seen("spice_jar")
    assert flute.affordance.region == "stem"
    first, most = first_force(flute), trial_lift_cap(flute, "stem")
    assert first is not None
    assert most is not None
    assert first < 0.77 * 4.0 < most < 4.0
    assert (trial_lift_cap(jar) or 0.0) > 4.0


def test_a_dent_in_a_strange_thing_is_no_filling() -> None:
    """A tall strange thing with a hollow of a tenth of its height in its own colour is empty; with something of another
    colour in it, or with a floor in a third of its depth, it counts as filled, and is not tilted."""

    def state(hollow: float, contents: tuple[int, ...] = ()) -> str:
        thing = SimpleNamespace(hollow=hollow, top=0.14, base=0.0, radius=0.022)
        item = SimpleNamespace(
            judgement=SimpleNamespace(category=UNKNOWN_CATEGORY), contents=contents, under=None, holds=False
        )
        return rgbd_perceiver._state(item, thing, ())  # pyright: ignore[reportPrivateUsage, reportArgumentType]

    assert state(0.1) == "empty"
    assert state(0.1, contents=(1,)) == "filled"
    assert state(0.35) == "filled"
