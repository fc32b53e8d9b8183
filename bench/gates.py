"""Calibration gates: what must hold before any method is measured (benchmark.md section 1).

    python -m bench.gates --trials 20 --markdown gates.md

(a) an empty hand and a hand that holds something drift less than 2 mm in 30 s; (b) oracle grasps (true poses, no noise)
succeed in at least 95 % of every SG and IT task; (c) random grasps succeed in less than 20 %; (d) lateral room of the
widest things is logged.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.attempt_once import attempt_once
from bench.loop_report import INTERACTION, SINGLE
from kb.base import Noun
from kb.grasp import MAX_APERTURE, Grasp
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan
from sim.controller import hold
from sim.panda import READY
from sim.pose import rotation_of
from tools.open_world import open_world
from tools.planning.candidate import leaning, vec3

DRIFT_LIMIT = 0.002
"""[m]"""
ORACLE_SHARE, RANDOM_SHARE = 0.95, 0.20
HOLD_S = 30.0
WIDE_SCENES = {"apple": "single_apple", "cup body": "single_cup", "vase body": "cup_near_vase"}
"""Things whose bodies nearly fill the hand (ledger G35)."""


class Gates(Noun):
    """What was measured."""

    empty_drift: float
    """Drift of the tool point of an empty hand in 30 s [m]."""
    hold_drift: dict[str, float]
    """Drift of the held object in the hand in 30 s [m], by scene."""
    oracle: dict[str, tuple[int, int]]
    """Successes and trials by scene."""
    random: dict[str, tuple[int, int]]
    room: dict[str, float]
    """Hand's opening less the body's width [m]: median over the seeds."""

    def passed(self) -> bool:
        """Whether all gates hold."""
        drifts = [self.empty_drift, *self.hold_drift.values()]
        oracle = all(good >= ORACLE_SHARE * count for good, count in self.oracle.values())
        good, count = (sum(pair[k] for pair in self.random.values()) for k in (0, 1))
        return max(drifts) < DRIFT_LIMIT and oracle and good < RANDOM_SHARE * max(1, count)


def random_grasp(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan:
    """Anywhere in the object's box, from any side, any opening and force: no thought at all."""
    del percept
    half = np.asarray(target.size) / 2
    local = rng.uniform(-half, half)
    cosine, sine = math.cos(target.yaw), math.sin(target.yaw)
    x = target.position[0] + cosine * local[0] - sine * local[1]
    y = target.position[1] + sine * local[0] + cosine * local[1]
    approach = leaning(rng.uniform(-math.pi, math.pi), rng.uniform(0.0, math.pi / 2))
    grasp = Grasp(
        position=vec3((x, y, max(0.012, target.position[2] + local[2]))),
        approach=approach,
        yaw=rng.uniform(-math.pi / 2, math.pi / 2),
        aperture=rng.uniform(0.02, MAX_APERTURE),
        force=rng.uniform(1.0, 70.0),
        type="power",
    )
    return plan.model_copy(update={"grasp": grasp, "joints": (), "candidate": "random"})


def run_gates(trials: int = 20, first_seed: int = 10000, workers: int = 2) -> Gates:
    """Measures all gates on seeds from `first_seed` on."""
    scenes = (*SINGLE, *INTERACTION)
    seeds = range(first_seed, first_seed + trials)
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        oracle = {scene: list(pool.map(partial(_succeeds, scene, at_random=False), seeds)) for scene in scenes}
        drawn = {scene: list(pool.map(partial(_succeeds, scene, at_random=True), seeds)) for scene in scenes}
    return Gates(
        empty_drift=empty_drift(),
        hold_drift={scene: hold_drift(scene, first_seed) for scene in ("single_cube", "single_bottle", "single_bowl")},
        oracle={scene: (sum(good), trials) for scene, good in oracle.items()},
        random={scene: (sum(good), trials) for scene, good in drawn.items()},
        room={name: lateral_room(name, scene, list(seeds)[:10]) for name, scene in WIDE_SCENES.items()},
    )


def _succeeds(scene: str, seed: int, *, at_random: bool) -> bool:
    once = attempt_once(scene, seed, bend=random_grasp if at_random else None)
    return once is not None and once.success


def empty_drift(seconds: float = HOLD_S) -> float:
    """How far the tool point wanders while an empty hand is held still [m]."""
    opened = open_world("single_cube", 10000)
    world = opened.world
    world.run(hold(READY, MAX_APERTURE, 1.0), "hold", None)
    before = world.read("robot/tcp_position").copy()
    world.run(hold(READY, MAX_APERTURE, seconds), "hold", None)
    return float(np.linalg.norm(world.read("robot/tcp_position") - before))


def hold_drift(scene: str, seed: int, seconds: float = HOLD_S) -> float:
    """How far a grasped object creeps in the hand in `seconds` of holding still [m]; inf if it could not be grasped."""
    held: dict[str, Any] = {}

    def keep(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan:
        held["plan"] = plan
        return plan

    once = attempt_once(scene, seed, bend=keep)
    if once is None or not once.success:
        return math.inf
    opened = open_world(scene, seed)
    opened.robot.grasp(held["plan"].grasp, joints=held["plan"].joints, shake=False)
    world, task = opened.world, opened.placed.task
    name = task.target if task is not None and task.target is not None else opened.placed.objects[0].id
    joints, grip = world.data.ctrl[0:21:3].copy(), float(world.data.ctrl[21])
    before = _in_hand(world, name)
    world.run(hold(joints, grip, seconds), "hold", None)
    return float(np.linalg.norm(_in_hand(world, name) - before))


def _in_hand(world: Any, name: str) -> NDArray[np.float64]:
    """Position of an object in the frame of the tool point [m], shape (3,)."""
    rotation = rotation_of(world.read("robot/tcp_quaternion"))
    return rotation.T @ (np.array(world.data.body(name).xpos) - world.read("robot/tcp_position"))


def lateral_room(name: str, scene: str, seeds: Sequence[int]) -> float:
    """Opening of the hand less the width of a body, median over seeds [m]."""
    rooms: list[float] = []
    category = name.split()[0]
    for seed in seeds:
        for thing in open_world(scene, seed).placed.objects:
            if thing.category == category:
                body = next((part for part in thing.parts if part.region == "body"), None)
                rooms.append(MAX_APERTURE - (body.width if body is not None else min(thing.size[:2])))
    return float(np.median(rooms)) if rooms else math.nan


def markdown(gates: Gates) -> str:
    """The report as a page."""
    lines = ["# Calibration gates", "", f"Passed: {'yes' if gates.passed() else 'no'}", ""]
    lines += [f"- empty hand, {HOLD_S:.0f} s: {1000 * gates.empty_drift:.3f} mm (limit 2)"]
    lines += [
        f"- {scene} held for {HOLD_S:.0f} s: {1000 * d:.3f} mm (limit 2)" for scene, d in gates.hold_drift.items()
    ]
    lines += [f"- lateral room of the {name}: {1000 * room:.1f} mm" for name, room in gates.room.items()]
    lines += ["", "| scene | oracle grasps (>= 95 %) | random grasps (< 20 % in all) |", "|---|---|---|"]
    for scene, (good, count) in gates.oracle.items():
        lines.append(f"| {scene} | {good}/{count} | {gates.random[scene][0]}/{gates.random[scene][1]} |")
    return "\n".join(lines) + "\n"


def main(argv: Sequence[str] | None = None) -> int:
    """Command line; exit code 0 if every gate holds."""
    parser = argparse.ArgumentParser(prog="python -m bench.gates", description="Measures the calibration gates.")
    parser.add_argument("--trials", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=10000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--markdown", type=Path, help="write the report there (default: standard output)")
    given = parser.parse_args(argv)
    gates = run_gates(given.trials, given.first_seed, given.workers)
    if given.markdown is not None:
        given.markdown.write_text(markdown(gates), encoding="utf-8")
    else:
        sys.stdout.write(markdown(gates))
    return 0 if gates.passed() else 1


if __name__ == "__main__":
    sys.exit(main())
