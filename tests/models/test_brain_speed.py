"""`ragvlm bench-brain` on a tiny model: every combination has its numbers, the ratio is against FP16."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytestmark = pytest.mark.models


def test_all_eight_combinations_are_measured(tmp_path: Path) -> None:
    """Four kinds of weights with two caches: speed, first token and memory are positive; FP16 is 1 by definition; NF4 weighs
    less than FP16; with the beginning of the prompt kept, fewer than half of its tokens are computed."""
    import torch

    from app.command_line import run_command_line

    torch.set_num_threads(1)
    file = tmp_path / "speed.json"
    arguments = ["bench-brain", "--device", "cpu", "--tokens", "6", "--repetitions", "1", "--json", str(file)]
    assert run_command_line(arguments) == 0
    rows = json.loads(file.read_text())["rows"]
    assert len({(row["weights"], row["cache"]) for row in rows}) == 8
    for row in rows:
        assert row["fault"] is None
        assert min(row["tokens_per_s"], row["first_token_s"], row["weights_mb"], row["peak_mb"], row["ratio"]) > 0
        assert row["first_token_kept_s"] > 0
        assert 0 < row["prefilled_tokens"] < 0.5 * row["prompt_tokens"]
    by = {(row["weights"], row["cache"]): row for row in rows}
    assert by["fp16", "bf16"]["ratio"] == 1.0
    assert by["nf4", "bf16"]["weights_mb"] < by["fp16", "bf16"]["weights_mb"]
