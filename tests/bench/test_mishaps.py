"""Mishaps: what they change, what they leave alone, and how recovery from them is counted."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.command_line import run_command_line
from bench.job import Job, Settings
from bench.mishaps import ARM_OFF, HEAVY, MISHAPS, NUDGE, SLIPPERY, WEAK, UnluckyRobot, changed_scene, nudge
from bench.report.mishaps import recovered, tables
from bench.report.results import Results
from bench.report.results_page import targets
from bench.report.success import other_suites
from bench.report.value import Count
from bench.run_job import run_job
from bench.suite import TWELVE, tasks_of
from bench.trial import digest
from kb.grasp import Grasp
from tests.bench_fixtures import lasting
from tests.report_fixtures import attempt_row, goal_row, trial_row
from tools.open_world import OpenedWorld, open_world

GRASP = Grasp(position=(0.5, 0.0, 0.03), approach=(0.0, 0.0, -1.0), yaw=0.3, aperture=0.07, force=20.0, type="power")


class Recorder:
    """A robot that only writes down what it was told."""

    def __init__(self) -> None:
        self.calls: list[tuple[Grasp, dict[str, Any]]] = []

    def grasp(self, grasp: Grasp, **options: Any) -> None:
        self.calls.append((grasp, options))


def test_each_of_the_twelve_with_each_mishap() -> None:
    """Names, groups and scenes; a task of another suite is refused."""
    tasks = tasks_of("mishaps")
    assert [task.name for task in tasks] == [f"{mishap}.{task}" for mishap in MISHAPS for task in TWELVE]
    assert {task.scene for task in tasks} == set(TWELVE)
    assert [task.mishap for task in tasks_of("mishaps", ["heavy", "nudged.single_cup"])] == ["heavy"] * 12 + ["nudged"]


def test_mishaps_need_physics(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The analytic evaluator is refused in one line, and nothing is written."""
    arguments = ["bench", "--suite", "mishaps", "--evaluator", "analytic", "--out", f"{tmp_path}/out"]
    assert run_command_line(arguments) == 2
    assert "--evaluator" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("task", ["cup_near_vase", "clear_table"])
def test_lasting_mishaps_change_one_thing(task: str) -> None:
    """Half the friction or twice the mass of the target (or of one thing), in physics too; all else stays."""
    plain = open_world(task, 10_003).placed
    for mishap in ("slippery", "heavy"):
        opened = open_world(task, 10_003, change=changed_scene(mishap))
        pairs = [(a, b) for a, b in zip(plain.objects, opened.placed.objects, strict=True) if repr(a) != repr(b)]
        ((before, after),) = pairs
        assert plain.task is not None
        assert plain.task.target in (None, before.id)
        friction, mass = (SLIPPERY, 1.0) if mishap == "slippery" else (1.0, HEAVY)
        assert after.friction == pytest.approx(friction * before.friction)
        assert after.mass == pytest.approx(mass * before.mass)
        assert sum(geom.mass for geom in after.geoms) == pytest.approx(mass * sum(geom.mass for geom in before.geoms))
        body = opened.world.index.objects[after.id].body
        assert opened.world.model.body_mass[body] == pytest.approx(after.mass, rel=1e-6)
    assert changed_scene("nudged") is None


def _places(opened: OpenedWorld) -> dict[str, np.ndarray]:
    world = opened.world
    return {
        o.id: world.data.qpos[world.index.objects[o.id].qpos][:3].copy() for o in opened.placed.objects if not o.fixed
    }


@pytest.mark.parametrize("task", ["single_bottle", "cup_near_vase", "ball_behind_box", "clear_table"])
def test_a_nudge_moves_one_thing_along_the_table(task: str) -> None:
    """The one nearest to the grasp, by at most 6 cm, not up, down or into anything; it rests there."""
    for seed in range(10_000, 10_004):
        opened = open_world(task, seed)
        before = _places(opened)
        near = min(before, key=lambda name: math.dist(before[name][:2], GRASP.position[:2]))
        moved = nudge(opened.world, GRASP, np.random.default_rng(seed))
        now = _places(opened)
        assert moved == near
        far = {name: float(np.linalg.norm(now[name] - before[name])) for name in before}
        assert 0.25 * NUDGE[0] < far.pop(moved) <= NUDGE[1] + 2e-3
        assert all(distance < 1e-3 for distance in far.values())
        assert now[moved][2] == pytest.approx(before[moved][2], abs=2e-3)
        opened.world.settle(0.2)
        assert np.allclose(_places(opened)[moved], now[moved], atol=1e-3)


def test_only_the_first_motion_suffers() -> None:
    """The hand goes beside, or closes weakly, once; from the next motion on it does as it is told."""
    opened = open_world("single_cube", 10_000)
    for mishap in ("arm_off", "weak_grip"):
        opened.world.attempt, told = 0, Recorder()
        robot = UnluckyRobot(told, opened.world, mishap)
        robot.grasp(GRASP, joints=(0.0,) * 7, most_force=30.0)
        opened.world.attempt = 1
        robot.grasp(GRASP, joints=(0.0,) * 7, most_force=30.0)
        (first, options), (second, later) = told.calls
        assert second == GRASP
        assert later == {"joints": (0.0,) * 7, "most_force": 30.0}
        if mishap == "arm_off":
            assert ARM_OFF[0] <= math.dist(first.position, GRASP.position) <= ARM_OFF[1]
            assert options["joints"] is None
        else:
            assert WEAK[0] * GRASP.force <= first.force <= WEAK[1] * GRASP.force
            assert options["most_force"] <= WEAK[1] * 30.0


def test_rows_with_a_mishap_are_the_same_again_and_share_the_first_attempt() -> None:
    """The same row twice; a blind retry begins with the very same failure; the robot looks again and recovers."""
    job = Job(
        settings=Settings(seed=14_000), task=tasks_of("mishaps", ["nudged.single_cube"])[0],
        configurations=("full", "blind_retry"), repetition=0, trial=0, seed=14_000, noise=1.0,
    )  # fmt: skip
    full, blind = run_job(job)
    assert (full.suite, full.scene, full.task) == ("mishaps", "single_cube", "nudged.single_cube")
    first, *more = full.goals[0].attempts
    assert not first.success
    assert more
    assert full.success
    assert first.evidence == blind.goals[0].attempts[0].evidence
    (alone,) = run_job(job.model_copy(update={"configurations": ("blind_retry",)}))
    assert lasting(alone) == lasting(blind)
    (plain,) = run_job(
        job.model_copy(update={"task": tasks_of("tasks", ["single_cube"])[0], "configurations": ("full",)})
    )
    assert len(plain.goals[0].attempts) == 1


def test_recovery_from_mishaps_is_counted_apart() -> None:
    """Their trials enter neither the headline nor the table of other suites, only their own table and target."""
    lost = [goal_row([attempt_row(0, False), attempt_row(1, True)])]
    gone = [goal_row([attempt_row(0, False), attempt_row(1, False)])]
    rows = [trial_row("full"), trial_row("blind_retry")]
    for name in ("full", "blind_retry"):
        more = {"suite": "mishaps", "goals": lost}
        rows += [trial_row(name, "nudged.single_cup", trial=n, **more) for n in range(3)]
        rows.append(trial_row(name, "heavy.single_cup", suite="mishaps", goals=gone if name == "full" else lost))
    results = Results([digest(row) for row in rows])
    assert len(results.of("full")) == 1
    assert not other_suites(results).rows
    assert recovered(results) == Count(3, 4)
    (aim,) = [item for item in targets(results) if "mishaps" in item.what]
    assert aim.met is True
    counted, against = tables(results)
    assert ("nudged", "full", Count(3, 3), Count(3, 3), Count(3, 3)) in [row[:5] for row in counted.rows]
    assert [row[:3] for row in against.rows][-1] == ("all", Count(3, 4), Count(4, 4))
    assert not tables(Results([digest(trial_row("full"))]))
