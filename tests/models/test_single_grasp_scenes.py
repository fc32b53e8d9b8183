"""`ragvlm run` with a language model on every single-grasp scene: the run ends, and every reply is valid by its schema.

Both kinds of constrained decoding: in this process with a grammar, and behind an OpenAI-compatible server.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.small_model_fixtures import small_model_server

pytestmark = pytest.mark.models

SCENES = ("single_cube", "single_cup", "single_bottle", "single_banana", "single_apple", "single_bowl")


@pytest.fixture(scope="module")
def brains(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, tuple[str, ...]]]:
    """Options of both brains: a tiny random Qwen3-VL, and SmolLM2-135M behind llama.cpp's server."""
    import torch

    from agent.brains.random_model import make_random_model

    torch.set_num_threads(1)
    folder = make_random_model(tmp_path_factory.mktemp("tiny"))
    with small_model_server() as address:
        yield {
            "hf": ("--brain", f"hf:{folder}?weights=fp32"),
            "openai": ("--brain", "openai:smollm2", "--base-url", address),
        }


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("kind", ["hf", "openai"])
def test_the_run_ends_and_every_reply_is_valid(
    kind: str, scene: str, brains: dict[str, tuple[str, ...]], tmp_path: Path
) -> None:
    """Exit 0 or 1 with a valid result, no server fault, nothing damaged; each recorded reply is of its role's schema."""
    from agent.brains.replies import AnswerReply, PerceiveReply, ReflectReply, ThinkReply, UnderstandReply, parse
    from app.command_line import run_command_line
    from kb.run_result import RunResult

    kinds = {
        "understand": UnderstandReply, "perceive": PerceiveReply, "think": ThinkReply, "reflect": ReflectReply,
        "answer": AnswerReply,
    }  # fmt: skip
    result_file, record = tmp_path / "result.json", tmp_path / "replies.jsonl"
    said = f"pick up the {scene.removeprefix('single_')}"
    arguments = ["run", said, "--scene", scene, "--seed", "10001", *brains[kind], "--json", str(result_file)]
    assert run_command_line([*arguments, "--record-brain", str(record)]) in (0, 1)
    result = RunResult.model_validate_json(result_file.read_text())
    assert result.model_use.calls > 0
    assert (result.model_use.faults, result.damage_events) == (0, 0)
    rows = [json.loads(line) for line in record.read_text().splitlines()[1:]]
    assert 0 < len(rows) <= result.model_use.calls
    for row in rows:
        assert parse(row["reply"], kinds[row["role"]])
