"""Every misuse gives one line on standard error, the promised exit code, and writes nothing.

The texts are pinned in tests/golden/command_line_errors.txt. After a wanted change write them again with
`RAGVLM_WRITE_GOLDEN=1 python -m pytest tests/app/test_command_line_errors.py`.
"""

from __future__ import annotations

import os
import shlex
from pathlib import Path

import pytest

from app.command_line import run_command_line

GOLDEN = Path(__file__).parents[1] / "golden" / "command_line_errors.txt"
CASES = (
    'run ""',
    'run "   "',
    "run LONG",
    'run "pick up the cup" --seed -1',
    'run "pick up the cup" --scene nowhere',
    'run "pick up the cup" --scene ""',
    'run "pick up the cup" --scene missing.yaml',
    'run "pick up the cup" --brain gpt',
    'run "pick up the cup" --brain openai:gpt-x',
    'run "pick up the cup" --brain hf:some/model',
    'run "pick up the cup" --perception eyes',
    'run "pick up the cup" --perception vlm',
    'run "pick up the cup" --evaluator bullet',
    'run "pick up the cup" --configuration everything',
    'run "pick up the cup" --thread ../../etc',
    'run "pick up the cup" --json missing/result.json',
    'run "pick up the cup" --json .',
    'run "pick up the cup" --record full',
    'run "pick up the cup" --record full/thesis.tex',
    'run "pick up the cup" --config missing.toml',
    'run "pick up the cup" --config bad.toml',
    'run "pick up the cup" --config broken.toml',
    "kb show --store missing.jsonl",
    "kb query cup --material cheese",
    "kb query cup --fragility 2",
    "scenes nowhere",
    "tools --schema Nothing",
    "show missing",
    "show full",
)
"""What is typed, as a shell would split it; LONG stands for 10,001 characters."""
ELSEWHERE: dict[str, str] = {
    'rum "pick up the cup"': "rum",
    "run": "INSTRUCTION",
    "run pick up the cup": "in quotes",
    'run "pick up the cup" --sed 3': "--seed",
    'run "pick up the cup" --seed three': "--seed",
    'run "pick up the cup" --seed 1.5': "--seed",
    'run "pick up the cup" --seed': "--seed",
    "chat --json x": "--json",
    "kb": "show, query, build",
    "kb shw": "shw",
    "kb show exp_nothing": "exp_nothing",
    "kb show --category spaceship": "spaceship",
    "kb query cup -k 0": "-k",
    "scenes cup_near_vase --seed -3": "--seed",
    "--colour": "--colour",
}
"""Cases whose words come from typer or from the knowledge base's content: what the line must mention."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a few bad files."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("RAGVLM_HOME", str(tmp_path / "home"))
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("years of work")
    (tmp_path / "bad.toml").write_text('colour = "red"\n')
    (tmp_path / "broken.toml").write_text("seed = = 3\n")
    return tmp_path


def golden() -> dict[str, tuple[int, str]]:
    """Case -> exit code and line."""
    found: dict[str, tuple[int, str]] = {}
    for block in GOLDEN.read_text(encoding="utf-8").strip().split("\n\n") if GOLDEN.exists() else []:
        case, code, line = block.split("\n")
        found[case.removeprefix("$ ragvlm ")] = (int(code.removeprefix("exit ")), line)
    return found


@pytest.mark.parametrize("case", CASES)
def test_misuse_is_answered_by_one_line(case: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One line on standard error, nothing on standard output, exit 2 (3 where the machine lacks something)."""
    before = sorted(path.name for path in folder.rglob("*"))
    arguments = ["a" * 10_001 if word == "LONG" else word for word in shlex.split(case)]
    code = run_command_line(arguments)
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("ragvlm: error: ")
    assert len(said.err.splitlines()) == 1
    assert code in (2, 3)
    assert sorted(path.name for path in folder.rglob("*")) == before
    _compare(case, code, said.err.rstrip("\n"))


@pytest.mark.parametrize("case", ELSEWHERE)
def test_misuse_found_by_the_parser_is_answered_by_one_line(
    case: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same holds for what the parser refuses: one line, exit 2, nothing written, and the culprit is named."""
    before = sorted(path.name for path in folder.rglob("*"))
    assert run_command_line(shlex.split(case)) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert ELSEWHERE[case] in said.err
    assert sorted(path.name for path in folder.rglob("*")) == before


def _compare(case: str, code: int, line: str) -> None:
    """With the golden text, or writes it where that is asked for."""
    texts = golden()
    if os.environ.get("RAGVLM_WRITE_GOLDEN"):
        texts[case] = (code, line)
        blocks = [f"$ ragvlm {name}\nexit {texts[name][0]}\n{texts[name][1]}" for name in CASES if name in texts]
        GOLDEN.write_text("\n\n".join(blocks) + "\n", encoding="utf-8")
    assert texts[case] == (code, line)


def test_the_golden_file_has_no_stale_cases() -> None:
    """Every pinned text belongs to a case."""
    assert set(golden()) == set(CASES)
