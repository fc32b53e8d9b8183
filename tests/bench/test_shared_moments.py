"""Moments of a shared analytic world: named instead of written, and still the very same world."""

from __future__ import annotations

from bench.shared_world import NAMED, SharedWorld
from kb.grasp import Grasp
from tools.open_world import OpenedWorld, open_world

CUBE, SEED = "single_cube", 11_004


def lifted(world: OpenedWorld) -> Grasp:
    """A grasp from above at the cube's place."""
    x, y, z = world.placed.objects[0].position
    return Grasp(position=(x, y, z + 0.025), approach=(0, 0, -1), yaw=0.3, aperture=0.08, force=10.0, type="power")


def facts(world: OpenedWorld) -> tuple[bytes, bytes]:
    """All of the world, and all that the observer knows."""
    return world.world.snapshot(), world.observer.state()


def test_a_named_moment_comes_back_as_a_written_one_does() -> None:
    """Start and the moment after a grasp, in both directions, are those of a world that writes its snapshots."""
    shared = SharedWorld.of(open_world(CUBE, SEED, evaluator="analytic"))
    plain = open_world(CUBE, SEED, evaluator="analytic")
    began, start = shared.snapshot(), plain.snapshot()
    assert began.startswith(NAMED)
    motion = lifted(plain)
    assert shared.robot.grasp(motion) == plain.robot.grasp(motion)
    after, held = shared.snapshot(), plain.snapshot()
    assert after != began
    for name, blob in ((began, start), (after, held), (began, start)):
        shared.restore(name)
        plain.restore(blob)
        assert facts(shared) == facts(plain)
        assert shared.motions == plain.motions


def test_later_judgements_do_not_reach_back() -> None:
    """What the observer learns after a moment is gone when that moment comes back."""
    shared = SharedWorld.of(open_world(CUBE, SEED, evaluator="analytic"))
    shared.robot.grasp(lifted(shared))
    after = shared.snapshot()
    shared.restore(after)
    before = facts(shared)
    shared.observer.judge(shared.motions, "cube")
    shared.observer.forget(0)
    shared.restore(after)
    assert facts(shared) == before


def test_the_physical_part_opens_elsewhere() -> None:
    """`physics_of` a named moment is what another world of the same scene and seed continues from."""
    shared = SharedWorld.of(open_world(CUBE, SEED, evaluator="analytic"))
    shared.robot.grasp(lifted(shared))
    after = shared.snapshot()
    other = open_world(CUBE, SEED, evaluator="analytic")
    other.restore(shared.physics_of(after))
    shared.restore(after)
    assert other.world.snapshot() == shared.world.snapshot()
    assert other.motions == shared.motions == 1
