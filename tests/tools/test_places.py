"""Places in the depth picture: empty once a thing was taken, occupied while it stands, unseen where something hides it."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from kb.percept import PerceivedObject, Percept
from kb.rgbd import RgbdView
from kb.sensing import Sensing
from tests.planning_fixtures import percept, solid
from tools.context import ToolContext
from tools.diagnosis.held_look import carries, look_at_places, worth_a_look
from tools.diagnosis.places import places, rests_on
from tools.open_world import OpenedWorld, open_world
from tools.perceive import PerceiveArgs, perceive
from tools.perception import RgbdPerceiver

HELD = Sensing(
    phase="shake", aperture_closed=0.04, aperture_lifted=0.04, aperture_end=0.04, load_end=0.04, lift_height=0.17
)
BLOCK = solid("t", "block", 0.5, 0.1)


def opened_with(taken: int) -> tuple[OpenedWorld, ToolContext, Percept]:
    """The two blocks and the ball as first perceived, and the world after one of them was raised by 17 cm."""
    opened = open_world("repeated_categories", 16_203)
    context = ToolContext(robot=opened.robot, perceiver=RgbdPerceiver(), rng=np.random.default_rng(3))
    before = perceive(PerceiveArgs(), context)
    poses = opened.observer.poses()
    seen = before.objects[taken].position
    name = min(poses, key=lambda key: float(np.linalg.norm(poses[key][:2] - np.asarray(seen[:2]))))
    address = opened.world.index.objects[name].qpos
    opened.world.data.qpos[address][2] += HELD.lift_height
    mujoco.mj_forward(opened.world.model, opened.world.data)
    return opened, context, before


@pytest.mark.parametrize("taken", [0, 1, 2])
def test_the_thing_that_was_raised_leaves_the_only_empty_place(taken: int) -> None:
    """Whichever is taken, its own place is empty and the others' are not, by the front camera alone."""
    opened, context, before = opened_with(taken)
    views = opened.robot.look(context.rng, ("front",))
    found = places(before.objects, views, HELD.lift_height)
    ids = [thing.id for thing in before.objects]
    assert found == {key: "empty" if number == taken else "occupied" for number, key in enumerate(ids)}


def test_the_twin_is_told_from_the_target() -> None:
    """The same look says "the target" of the one that was meant, and "the other" where its twin was meant."""
    _, context, before = opened_with(0)
    kinds = [thing.category for thing in before.objects]
    twin = next(t for number, t in enumerate(before.objects) if number and kinds[number] == kinds[0])
    assert look_at_places(HELD, before, before.objects[0], context).is_target
    word = look_at_places(HELD, before, twin, context)
    assert (word.is_other, word.emptied) == (True, (before.objects[0].id,))


def test_glass_that_stands_in_bad_light_leaves_no_empty_place() -> None:
    """At twice the noise hardly a pixel on a glass is measured, and those are seen behind it: that is no empty place."""
    opened = open_world("phone_near_wine_glass", 13_004, noise=2.0)
    context = ToolContext(robot=opened.robot, perceiver=RgbdPerceiver(), rng=np.random.default_rng(3))
    before = perceive(PerceiveArgs(), context)
    glass = [thing.id for thing in before.objects if thing.transparent]
    found = places(before.objects, opened.robot.look(context.rng), HELD.lift_height)
    assert glass
    assert [found[key] for key in glass] == ["unseen"] * len(glass)


def test_what_the_arm_hides_is_unseen() -> None:
    """A sheet half way to the table before every pixel: no place is empty, none occupied, and nothing is doubted."""
    opened, context, before = opened_with(0)
    views: tuple[RgbdView, ...] = opened.robot.look(context.rng)
    hidden = tuple(replace(view, depth=np.minimum(view.depth, np.float32(0.5))) for view in views)
    assert set(places(before.objects, hidden, HELD.lift_height).values()) == {"unseen"}


def test_a_look_is_taken_only_where_it_may_tell_something() -> None:
    """Alone and sure: none. With a twin, with a thing of like weight, or in doubt: one. With an empty hand: none."""
    ball, vase = solid("n", "tennis_ball", 0.5, -0.1), solid("n", "vase", 0.5, -0.1)

    def wanted(*others: PerceivedObject, sure: bool = True, sensed: Sensing = HELD) -> bool:
        return worth_a_look(sensed, percept(BLOCK, *others), BLOCK, sure=sure)

    assert not wanted()
    assert wanted(sure=False)
    assert wanted(solid("n", "block", 0.5, -0.1))
    assert wanted(ball)
    assert not wanted(vase)
    empty = HELD.model_copy(update={"load_end": 0.0})
    assert not carries(empty)
    assert not wanted(ball, sure=False, sensed=empty)


def test_what_stood_on_the_target_leaves_with_it() -> None:
    """A block on a bowl is not another thing that vanished; one beside it is."""
    bowl = solid("t", "bowl", 0.5, 0.0)
    on, beside = solid("n", "block", 0.5, 0.0), solid("n", "block", 0.5, 0.2)
    x, y, z = on.position
    assert rests_on(on.model_copy(update={"position": (x, y, z + bowl.size[2])}), bowl)
    assert not rests_on(beside, bowl)
