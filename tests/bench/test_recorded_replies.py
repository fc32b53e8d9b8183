"""A benchmark with a language model: identical prompts of all configurations get identical replies, also without the model."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from app.command_line import run_command_line
from tests.brain_fixtures import GOOD, fault_server, think, understand

REPLIES = {**GOOD, "understand": understand({"action": "pick", "thing": "the cube"}), "think": think(speed_percent=70)}
TIMED = ("wall_s", "timings_s", "bare_step_ratio", "model_use", "brain")
SHARED = ("shared_looks", "shared_motions", "shared_steps")


def rows(out: Path) -> list[dict[str, Any]]:
    """The trials of a benchmark without times."""
    lines = [json.loads(line) for line in (out / "trials.jsonl").read_text().splitlines()]
    kept = [{key: value for key, value in line.items() if key not in (*TIMED, *SHARED)} for line in lines]
    return sorted(kept, key=lambda row: (row["configuration"], row["seed"]))


def test_all_configurations_see_the_same_replies_and_a_replay_asks_nobody(tmp_path: Path) -> None:
    """Two configurations on two worlds put eight questions, of which half are the other half again: the server is asked each
    once. Replayed without the server, every trial has the same grasps, forces and outcome, with the model's speed of 0.7."""
    record = tmp_path / "replies.jsonl"
    command = [
        "bench", "--tasks", "single_cube", "--configs", "full,no_recovery", "--trials", "2", "--workers", "1",
        "--seed", "10001", "--evaluator", "analytic",
    ]  # fmt: skip
    with fault_server(("by_role", REPLIES)) as server:
        asking = ["--brain", "openai:good", "--base-url", server.url, "--record-brain", str(record)]
        assert run_command_line([*command, *asking, "--out", str(tmp_path / "asked")]) == 0
        assert len(server.requests) == 4
    assert len(record.read_text().splitlines()) == 1 + 4
    assert run_command_line([*command, "--brain", f"replay:{record}", "--out", str(tmp_path / "replayed")]) == 0
    asked, replayed = rows(tmp_path / "asked"), rows(tmp_path / "replayed")
    assert asked == replayed
    assert len(asked) == 4
    assert all(row["goals"][0]["attempts"][0]["grasp"]["speed"] == 0.7 for row in asked)
