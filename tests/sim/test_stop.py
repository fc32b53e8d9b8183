"""A stop from any thread at any moment of a motion: the physics stands still at once, the arm holds, the grip stays."""

from __future__ import annotations

import threading
import time
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest

import sim.world
from kb.grasp import Grasp
from tools.open_world import OpenedWorld, open_world

GRASP = Grasp(
    position=(0.5, 0.0, 0.0), approach=(0.0, 0.0, -1.0), yaw=0.0, aperture=0.075, force=12.0, type="power", standoff=0.1
)
PROMISE_S = 0.05
"""Time after which the physics stands still [s]."""


class Steps:
    """Stands in for `mujoco` in `sim.world`: counts steps, presses the stop at one of them, and times what follows."""

    def __init__(self, opened: OpenedWorld) -> None:
        self.opened = opened
        self.press_at: int | None = None
        self.count = 0
        self.pressed = self.last = 0.0

    def mj_step(self, *args: Any) -> None:
        """One step of the physics."""
        mujoco.mj_step(*args)
        self.count += 1
        if self.count == self.press_at:
            presser = threading.Thread(target=self.opened.stop.press)
            presser.start()
            presser.join()
            # CPU time of the thread that steps: what else the machine does at the time is not measured.
            self.pressed = time.thread_time()
        self.last = time.thread_time()

    def __getattr__(self, name: str) -> Any:
        return getattr(mujoco, name)


@pytest.fixture(scope="module")
def opened() -> OpenedWorld:
    """A cube on a table."""
    return open_world("single_cube", 10_001)


@pytest.fixture(scope="module")
def bench(opened: OpenedWorld) -> SimpleNamespace:
    """The grasp of the cube, and the moment before it."""
    cube = opened.observer.poses()["cube"]
    turn = 2 * np.arctan2(cube[6], cube[3])
    grasp = GRASP.model_copy(update={"position": (float(cube[0]), float(cube[1]), 0.025), "yaw": float(turn)})
    return SimpleNamespace(opened=opened, grasp=grasp, start=opened.world.snapshot())


def stopped_at(bench: SimpleNamespace, monkeypatch: pytest.MonkeyPatch, moment: float, total: int) -> tuple[float, Any]:
    """Stops the grasp at a share of its steps: seconds until the last step, and what was sensed."""
    steps = Steps(bench.opened)
    steps.press_at = 1 + int(moment * (total - 1))
    bench.opened.world.restore(bench.start)
    bench.opened.observer.forget()
    with monkeypatch.context() as patched:
        patched.setattr(sim.world, "mujoco", steps)
        sensing = bench.opened.robot.grasp(bench.grasp)
    return steps.last - steps.pressed, sensing


def full_length(bench: SimpleNamespace, monkeypatch: pytest.MonkeyPatch) -> int:
    """Steps of the undisturbed grasp, which holds the cube."""
    steps = Steps(bench.opened)
    bench.opened.world.restore(bench.start)
    with monkeypatch.context() as patched:
        patched.setattr(sim.world, "mujoco", steps)
        sensing = bench.opened.robot.grasp(bench.grasp)
    assert sensing.load_end > 0.03
    return steps.count


def check(bench: SimpleNamespace, monkeypatch: pytest.MonkeyPatch, moments: np.ndarray) -> None:
    """Every stop is in time, an outcome, and final until it is released."""
    total = full_length(bench, monkeypatch)
    late: list[float] = []
    for moment in moments:
        waited, sensing = stopped_at(bench, monkeypatch, float(moment), total)
        late.append(waited)
        assert sensing.stopped_by == "stop"
        world, held = bench.opened.world, bench.opened.robot.holding
        before = world.time, world.data.qpos.copy(), float(world.model.actuator_forcerange[world.index.gripper, 1])
        again = bench.opened.robot.go_home()
        assert again.stopped_by == "stop"
        assert (world.time, before[2]) == (before[0], float(world.model.actuator_forcerange[world.index.gripper, 1]))
        assert np.array_equal(world.data.qpos, before[1])
        if held and sensing.phase != "close":  # while the fingers close their force is still rising
            assert bench.opened.robot.grip_force == pytest.approx(bench.grasp.force, rel=0.3)
        bench.opened.stop.release()
    assert float(np.quantile(late, 0.99)) <= PROMISE_S


@pytest.mark.slow
def test_physics_stands_still_within_50_ms(bench: SimpleNamespace, monkeypatch: pytest.MonkeyPatch) -> None:
    """At 20 random moments of a grasp; a further motion does not begin, and what is held stays held."""
    check(bench, monkeypatch, np.random.default_rng(5).random(20))


@pytest.mark.long
def test_physics_stands_still_at_200_moments(bench: SimpleNamespace, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same at 200 random moments."""
    check(bench, monkeypatch, np.random.default_rng(6).random(200))


def test_what_is_held_stays_held_after_the_stop(bench: SimpleNamespace, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stopped while carrying: the load is still in the hand after the release, and can be put down."""
    total = full_length(bench, monkeypatch)
    stopped_at(bench, monkeypatch, 0.8, total)
    assert bench.opened.robot.holding
    bench.opened.stop.release()
    assert bench.opened.robot.release_and_home().stopped_by is None
    assert not bench.opened.robot.holding


def test_the_switch_counts_from_its_first_press() -> None:
    """Pressing again does not start the clock anew; released, nothing waits."""
    from sim.stop import StopSwitch

    switch = StopSwitch()
    assert switch.waited == 0.0
    switch.press()
    first = switch.waited
    switch.press()
    assert switch.waited >= first
    switch.release()
    assert (switch.pressed, switch.waited) == (False, 0.0)
