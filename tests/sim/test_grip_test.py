"""The test lift: a grip that is too weak learns the weight and holds; one that suffices stays as it is."""

from __future__ import annotations

import math

import pytest

from kb.grasp import Grasp
from sim.draw_scene import draw_scene
from sim.grip_test import LONGEST_ARM, MARGIN, POOR_FRICTION, TWIST_FRICTION, TWIST_RADIUS, needed_force
from sim.observer import Observer
from sim.robot import Robot
from sim.scene_spec import ObjectSpec, SceneSpec
from sim.world import World

SOUP_CAN = SceneSpec(name="t", objects=(ObjectSpec(id="can", model="soup_can", position=(0.5, 0.05)),))


def _lifted(force: float, most: float | None) -> tuple[float, float, bool]:
    """Raise of the grip [N], mass felt at the end [kg], and success, for a can of 0.4 kg taken from above."""
    world = World(draw_scene(SOUP_CAN, 3))
    observer = Observer(world)
    x, y, _ = world.placed.objects[0].position
    grasp = Grasp(
        position=(x, y, 0.068), approach=(0, 0, -1), yaw=math.pi / 2, aperture=0.08, force=force, type="power"
    )
    sensed = Robot(world).grasp(grasp, most_force=most)
    return sensed.grip_raised, sensed.load_end, observer.judge(world.attempt, "can").success


def test_a_weak_grip_is_raised_and_holds() -> None:
    """With 3 N per finger the can is lost; with leave to press up to 20 N it is held, and its weight is felt."""
    assert not _lifted(3.0, None)[2]
    raised, mass, success = _lifted(3.0, 20.0)
    assert success
    assert 0.0 < raised <= 17.0
    assert mass == pytest.approx(0.40, rel=0.06)


def test_the_limit_is_kept() -> None:
    """Whatever slips, the grip never exceeds what the object is taken to bear."""
    raised, _, success = _lifted(2.0, 2.5)
    assert raised <= 0.5 + 1e-9
    assert not success


def test_a_sufficient_grip_is_left_alone() -> None:
    """12 N hold the can by the margin at poor friction, so nothing changes."""
    raised, _, success = _lifted(14.0, 20.0)
    assert raised == 0.0
    assert success


def test_needed_force_is_margin_over_friction() -> None:
    """Weight over twice the friction coefficient, times the margin; torque by the pads' radius; the larger one counts."""
    assert needed_force(0.4, 0.0) == pytest.approx(MARGIN * 0.4 * 9.81 / (2 * POOR_FRICTION))
    assert needed_force(0.4, 0.4) == needed_force(0.4, -0.4) > needed_force(0.4, 0.3) > needed_force(0.4, 0.0)
    assert needed_force(-1.0, 0.0) == 0.0


def test_a_torque_that_no_lever_explains_counts_as_far_as_one_does() -> None:
    """60 g cannot pull with 0.25 N m: what is reckoned with is their weight on the longest arm."""
    most = 0.06 * 9.81 * LONGEST_ARM / (2 * TWIST_FRICTION * TWIST_RADIUS)
    assert needed_force(0.06, 0.25) == pytest.approx(most)
