"""SmolLM2-135M from its package behind llama.cpp's own OpenAI server, in this process: a whole `ragvlm run` through it.

The model is far too small for the task, and its choices may be poor; the run must stay valid and end.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.small_model_fixtures import small_model_server

pytestmark = pytest.mark.models


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    """Address of the running server."""
    with small_model_server() as address:
        yield address


def test_a_whole_run_is_valid_and_ends(server: str, tmp_path: Path) -> None:
    """`ragvlm run` ends with 0 or 1 and a valid result; replies were constrained to their schemas by the server's grammar;
    nothing broke; the picture that the server cannot take was left out."""
    from app.command_line import run_command_line
    from kb.run_result import RunResult

    file = tmp_path / "result.json"
    arguments = [
        "run", "pick up the cube", "--scene", "single_cube", "--seed", "10001", "--brain", "openai:smollm2",
        "--base-url", server, "--json", str(file), "--record-brain", str(tmp_path / "brain.jsonl"),
    ]  # fmt: skip
    assert run_command_line(arguments) in (0, 1)
    result = RunResult.model_validate_json(file.read_text())
    assert result.brain == "openai:smollm2"
    assert result.model_use.calls > 0
    assert result.model_use.faults == 0
    assert result.damage_events == 0
    rows = [json.loads(line) for line in (tmp_path / "brain.jsonl").read_text().splitlines()[1:]]
    assert all(isinstance(json.loads(row["reply"]), dict) for row in rows)


def test_a_wrong_port_ends_with_the_mend(capsys: pytest.CaptureFixture[str]) -> None:
    """Nobody listens there: exit 3 with the mend, after the trials."""
    from app.command_line import run_command_line

    arguments = ["run", "x", "--scene", "single_cube", "--brain", "openai:m", "--base-url", "http://127.0.0.1:9/v1"]
    assert run_command_line(arguments) == 3
    assert "--base-url" in capsys.readouterr().err
