"""The commands that list what there is, and the speed of help."""

from __future__ import annotations

import json
import resource
import subprocess
import sys

import jsonschema
import pytest

from app.command_line import run_command_line
from app.schemas import TOOL_NAMES
from kb.run_result import RunResult
from sim.ood_catalogue import ALL_MODELS
from sim.scene_file import builtin_scenes


def output(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Standard output of a command that must succeed and say nothing on standard error."""
    assert run_command_line(list(arguments)) == 0
    said = capsys.readouterr()
    assert said.err == ""
    return said.out


def test_help_is_fast_and_loads_nothing_heavy() -> None:
    """`--help` costs at most 0.6 s of processor time in a new process, without physics, graph or arrays.

    Processor time, because the wall time of a test depends on what else the machine does.
    """
    code = (
        "import sys; from app.command_line import run_command_line; run_command_line(['--help']); "
        "heavy = {'mujoco', 'numpy', 'langgraph', 'langchain_core', 'chromadb', 'scipy', 'matplotlib', 'pydantic'}; "
        "sys.exit(len(heavy & set(sys.modules)))"
    )
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.returncode == 0
    assert (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime) <= 0.6


@pytest.mark.parametrize("command", ["run", "chat", "kb", "show", "scenes", "objects", "tools", "doctor"])
def test_every_listed_command_has_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Each command explains itself with exit 0."""
    assert "Usage" in output(capsys, command, "--help")


def test_without_arguments_it_shows_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    """`ragvlm` alone is the help."""
    assert "doctor" in output(capsys)


def test_scenes_lists_every_built_in_scene(capsys: pytest.CaptureFixture[str]) -> None:
    """One tab-separated line a scene in a pipe, with something to say to it."""
    lines = output(capsys, "scenes").splitlines()
    assert {line.split("\t")[0] for line in lines[1:]} == set(builtin_scenes())
    assert all(line.count("\t") == 2 and line.split("\t")[2] for line in lines)


def test_a_scene_is_described_with_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    """The drawn objects of a seed, said to be the truth; another seed draws others."""
    first = output(capsys, "scenes", "cup_near_vase", "--seed", "3")
    assert "the truth" in first
    assert "vase" in first
    assert first != output(capsys, "scenes", "cup_near_vase", "--seed", "4")


def test_objects_lists_the_catalogue(capsys: pytest.CaptureFixture[str]) -> None:
    """Every model with plausible nominal numbers, as a table and as JSON."""
    rows = json.loads(output(capsys, "objects", "--json"))
    assert [row["model"] for row in rows] == list(ALL_MODELS)
    assert all(0 < side < 1.0 for row in rows for side in row["size_m"])
    assert len(output(capsys, "objects").splitlines()) == len(ALL_MODELS) + 1


def test_tools_prints_valid_schemas(capsys: pytest.CaptureFixture[str]) -> None:
    """Each tool's argument schema is itself a valid JSON schema with a described purpose."""
    rows = json.loads(output(capsys, "tools"))
    assert tuple(rows) == TOOL_NAMES
    for row in rows.values():
        jsonschema.Draft202012Validator.check_schema(row["arguments"])
        assert row["description"].endswith(".")
        assert row["arguments"]["properties"]


def test_the_schema_of_the_result_accepts_results(capsys: pytest.CaptureFixture[str]) -> None:
    """`tools --schema RunResult` describes what `--json` writes: a result passes, a renamed key does not."""
    schema = json.loads(output(capsys, "tools", "--schema", "RunResult"))
    result = RunResult(
        instruction="x", scene="s", seed=0, configuration="full", brain="rules", perception="rgbd", evaluator="mujoco",
        executed=False, success=False, answer="no",
    )  # fmt: skip
    good = json.loads(result.model_dump_json())
    jsonschema.validate(good, schema)
    bad = {**good, "succes": True}
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(bad, schema)


def test_tools_says_what_each_tool_is_for(capsys: pytest.CaptureFixture[str]) -> None:
    """`--names` is a short list."""
    assert len(output(capsys, "tools", "--names").splitlines()) == len(TOOL_NAMES) + 1


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("ragvlm run x --scene single_c", {"single_cup", "single_cube"}),
        ("ragvlm run x --perception o", {"oracle"}),
        ("ragvlm run x --evaluator a", {"analytic"}),
        ("ragvlm kb q", {"query"}),
    ],
)
def test_the_shell_completes_values(
    words: str, offered: set[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Pressing Tab after these words offers exactly what fits."""
    monkeypatch.setenv("_RAGVLM_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
    with pytest.raises(SystemExit) as caught:
        run_command_line([])
    assert caught.value.code == 0
    assert set(capsys.readouterr().out.split()) == offered
