"""Measures the whole loop: runs scenes over a range of seeds and reports successes with intervals, and wall times.

    python -m bench.loop_report --seeds 10000-10009
    python -m bench.loop_report --seeds 10000-10004 --scenes single_cup,cup_near_vase --markdown report.md

Success is the observer's word. Every run counts; a run that raises is a failure and is listed as a crash.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import median
from typing import Any

from kb.errors import BadInputError

SINGLE = ("single_cup", "single_apple", "single_bottle", "single_banana", "single_bowl", "single_cube")
"""The SG tasks of the benchmark."""
INTERACTION = ("cup_near_vase", "ball_behind_box", "phone_near_wine_glass", "screwdriver_side_grasp")
"""The IT tasks."""
Z95 = 1.959963984540054
"""Two-sided 95 % quantile of the normal distribution."""

Row = dict[str, Any]


def wilson(successes: int, count: int) -> tuple[float, float]:
    """95 % Wilson score interval of a proportion."""
    if count == 0:
        return 0.0, 1.0
    share, z2 = successes / count, Z95**2
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = Z95 / (1 + z2 / count) * ((share * (1 - share) + z2 / (4 * count)) / count) ** 0.5
    return max(0.0, middle - half), min(1.0, middle + half)


def parse_seeds(text: str) -> list[int]:
    """Seeds from words like `3`, `3,5` or `10000-10009`.

    Raises:
        BadInputError: not of that form.
    """
    seeds: list[int] = []
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        if not first.isdecimal() or (dash and not last.isdecimal()):
            raise BadInputError(f'"{part}" is no seed and no range', where="--seeds", choices=("7", "3,5", "10-19"))
        seeds += range(int(first), int(last if dash else first) + 1)
    if not seeds:
        raise BadInputError("it names no seed", where="--seeds")
    return seeds


def run_one(job: tuple[str, int, str, str, str]) -> Row:
    """One run in this process: what came out, in plain data. Never raises: a crash is a row.

    Args:
        job: Scene, seed, perception, evaluator, configuration.
    """
    scene, seed, perception, evaluator, configuration = job
    start = time.perf_counter()
    row: Row = {"scene": scene, "seed": seed, "crash": None}
    try:
        from agent import build_agent

        agent = build_agent(
            scene=scene,
            seed=seed,
            perception=perception,  # pyright: ignore[reportArgumentType]
            evaluator=evaluator,  # pyright: ignore[reportArgumentType]
            configuration=configuration,
        )
        result = agent.run(instruction_of(scene, seed))
        row |= summary(json.loads(result.model_dump_json()))
    except Exception as error:  # every run counts, also one that crashes
        row |= {"crash": f"{type(error).__name__}: {' '.join(str(error).split())[:200]}", "success": False}
    row["wall_s"] = time.perf_counter() - start
    return row


def instruction_of(scene: str, seed: int) -> str:
    """One of the task's own sentences, by turns of the seed."""
    from sim.scene_file import load_scene

    task = load_scene(scene).task
    sentences = task.instructions if task is not None else ()
    if not sentences:
        raise BadInputError("the scene has no task", where=scene)
    return sentences[seed % len(sentences)]


def summary(result: Row) -> Row:
    """What the report needs of a result."""
    goal = result["goals"][0] if result["goals"] else {"claimed": False, "attempts": []}
    attempts = goal["attempts"]
    times = result["timings_s"]
    return {
        "instruction": result["instruction"],
        "success": result["success"],
        "claimed": goal["claimed"],
        "attempts": len(attempts),
        "first": bool(attempts and attempts[0]["success"]),
        "diagnosed": [a["failure"] for a in attempts if not a["claimed"]],
        "observed": [a["observed_failure"] for a in attempts if not a["success"]],
        "damage": result["damage_events"],
        "required": sum(c["required"] for c in result["constraints"]),
        "satisfied": sum(c["required"] and c["satisfied"] for c in result["constraints"]),
        "inferred": sum(c["required"] and c["inferred"] for c in result["constraints"]),
        "answer": result["answer"],
        "times": times,
        "to_plan_s": times["perception"] + times["retrieval"] + times["planning"] if len(attempts) == 1 else None,
    }


def run_all(jobs: Sequence[tuple[str, int, str, str, str]], workers: int, done: Any = None) -> list[Row]:
    """All jobs over worker processes, in the order of the jobs; each worker's first run is marked as cold."""
    context = multiprocessing.get_context("spawn")
    rows: list[Row] = []
    with ProcessPoolExecutor(workers, mp_context=context, initializer=_one_thread) as pool:
        for row in pool.map(_marked, jobs):
            rows.append(row)
            if done is not None:
                done(len(rows), len(jobs), row)
    return rows


def _one_thread() -> None:
    """Numerical libraries stay on one thread: the processes are the parallelism."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"


_warm = False


def _marked(job: tuple[str, int, str, str, str]) -> Row:
    global _warm
    row = {**run_one(job), "warm": _warm, "process": os.getpid()}
    _warm = True
    return row


def time_cold(jobs: Sequence[tuple[str, int, str, str, str]]) -> list[float]:
    """Wall times [s] of `ragvlm run` as a person starts it: a new process each, imports included, nothing in parallel."""
    times: list[float] = []
    for scene, seed, perception, evaluator, configuration in jobs:
        command = [
            sys.executable, "-m", "app", "run", instruction_of(scene, seed), "--scene", scene, "--seed", str(seed),
            "--perception", perception, "--evaluator", evaluator, "--configuration", configuration,
        ]  # fmt: skip
        start = time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        times.append(time.perf_counter() - start)
    return times


def report(rows: Sequence[Row], cold: Sequence[float], title: str) -> str:
    """The measurement as Markdown."""
    lines = [f"# {title}", "", *_successes(rows), "", *_honesty(rows), "", *_times(rows, cold), ""]
    failed = [row for row in rows if not row["success"]]
    if failed:
        lines += ["## Runs that did not succeed", "", "| scene | seed | attempts | diagnosed | observed | claimed |"]
        lines += ["|---|---|---|---|---|---|"]
    for row in failed:
        if row["crash"]:
            lines.append(f"| {row['scene']} | {row['seed']} | crash | {row['crash']} | | |")
        else:
            words = [", ".join(str(word) for word in row[key]) for key in ("diagnosed", "observed")]
            lines.append(
                f"| {row['scene']} | {row['seed']} | {row['attempts']} | {words[0]} | {words[1]} | {row['claimed']} |"
            )
    return "\n".join(lines).rstrip() + "\n"


def _successes(rows: Sequence[Row]) -> list[str]:
    lines = [
        "| scene | runs | succeeded | 95 % Wilson | first attempt | attempts | constraints kept | damage | crashes |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    for scene in [*scenes, "all"]:
        own = [row for row in rows if scene in ("all", row["scene"])]
        good = sum(row["success"] for row in own)
        low, high = wilson(good, len(own))
        ran = [row for row in own if not row["crash"]]
        lines.append(
            f"| {scene} | {len(own)} | {good} | {low:.1%} to {high:.1%} | {sum(row['first'] for row in ran)} | "
            f"{sum(row['attempts'] for row in ran)} | {sum(row['satisfied'] for row in ran)} of "
            f"{sum(row['required'] for row in ran)} | {sum(row['damage'] for row in ran)} | {len(own) - len(ran)} |"
        )
    return lines


def _honesty(rows: Sequence[Row]) -> list[str]:
    ran = [row for row in rows if not row["crash"]]
    false = sum(row["claimed"] and not row["success"] for row in ran)
    missed = sum(row["success"] and not row["claimed"] for row in ran)
    return [f"False claims of success: {false} of {len(ran)} runs; missed successes: {missed}."]


def _times(rows: Sequence[Row], cold: Sequence[float]) -> list[str]:
    """Medians of the wall times and of their parts, over warm runs."""
    warm = [row for row in rows if row.get("warm") and not row["crash"]]
    lines = ["## Wall times", "", "| what | runs | median s | largest s |", "|---|---|---|---|"]

    def line(name: str, values: Iterable[float]) -> str:
        found = list(values)
        if not found:
            return f"| {name} | 0 | – | – |"
        return f"| {name} | {len(found)} | {median(found):.2f} | {max(found):.2f} |"

    lines.append(line("warm run (same process, agent built anew)", (row["wall_s"] for row in warm)))
    if cold:
        lines.append(line("cold run (`ragvlm run` in a new process)", cold))
    lines.append(
        line("perception to plan, runs of one attempt", (r["to_plan_s"] for r in warm if r["to_plan_s"] is not None))
    )
    for part in ("perception", "retrieval", "planning", "execution", "brain"):
        lines.append(line(f"of which {part}", (row["times"][part] for row in warm)))
    return lines


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line of the measurement."""
    parser = argparse.ArgumentParser(
        prog="python -m bench.loop_report", description="Measures the whole loop over scenes and seeds."
    )
    parser.add_argument("--seeds", required=True, help="for example 10000-10009")
    parser.add_argument("--scenes", default=",".join(SINGLE + INTERACTION), help="comma-separated (default: SG and IT)")
    parser.add_argument("--perception", default="rgbd")
    parser.add_argument("--evaluator", default="mujoco")
    parser.add_argument("--configuration", default="full")
    parser.add_argument("--workers", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--cold", type=int, default=3, help="runs to time in a new process each (default 3)")
    parser.add_argument("--jsonl", type=Path, help="write one line a run")
    parser.add_argument("--markdown", type=Path, help="write the report there (default: standard output)")
    given = parser.parse_args(arguments)
    try:
        seeds = parse_seeds(given.seeds)
    except BadInputError as error:
        parser.error(str(error))
    scenes = [name.strip() for name in given.scenes.split(",") if name.strip()]
    jobs = [(s, seed, given.perception, given.evaluator, given.configuration) for s in scenes for seed in seeds]
    rows = run_all(jobs, max(1, given.workers), _progress)
    cold = time_cold(jobs[:: max(1, len(jobs) // given.cold)][: given.cold]) if given.cold > 0 else []
    if given.jsonl:
        given.jsonl.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    text = report(rows, cold, f"The loop on {len(scenes)} scenes, seeds {given.seeds}, {given.perception} perception")
    if given.markdown:
        given.markdown.write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)
    return 0


def _progress(done: int, total: int, row: Row) -> None:
    word = "crash" if row["crash"] else "success" if row["success"] else "failure"
    sys.stderr.write(f"{done}/{total} {row['scene']} {row['seed']}: {word} in {row['wall_s']:.1f} s\n")


if __name__ == "__main__":
    sys.exit(main())
