"""Learning from the command line: a session that learns, and the commands that look at what was learnt."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from app.command_line import run_command_line
from app.learning import Learner
from app.options import RunOptions
from app.session import Session
from kb.errors import EnvironmentFaultError
from kb.learned import LearnedBase
from kb.shape_colour import ShapeColourEmbedder
from tests.experience_fixtures import make_store

WORDS = "pick up the cube"


class MeanColour:
    """A stand-in for a learnt embedder: the mean colour of what is masked."""

    name, dim = "mean-colour", 3

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None
    ) -> NDArray[np.float64]:
        """A unit vector (3,)."""
        colour = rgb[mask].mean(axis=0) + 1.0
        return colour / np.linalg.norm(colour)


def session(folder: Path) -> Session:
    """A quick world, with a learning knowledge base of its own."""
    return Session(
        RunOptions(
            scene="single_cube", seed=10003, evaluator="analytic", perception="oracle", kb=str(folder), learn=True
        )
    )


def test_a_run_that_learns_enters_its_attempts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A claimed success is lifted again and entered as a lesson; result and world stay what they were without learning;
    log, diff and rollback show it."""
    folder = tmp_path / "kb"
    with session(folder) as talk:
        steps = list(talk.stream(WORDS))
        result, motions = talk.result, talk._agent.opened.motions
    with Session(RunOptions(scene="single_cube", seed=10003, evaluator="analytic", perception="oracle")) as plain:
        list(plain.stream(WORDS))
        assert result.goals[0].attempts[0].grasp == plain.result.goals[0].attempts[0].grasp
        assert motions == plain._agent.opened.motions
    assert any("lift it again" in step.text for step in steps)
    base = LearnedBase.open(folder)
    lesson = base.journal.changes[1].lesson
    assert lesson is not None
    assert (lesson.category, lesson.claimed, lesson.confirmed, lesson.seed) == ("cube", True, True, 10003)
    assert run_command_line(["kb", "log", "--kb", str(folder), "--all", "--json"]) == 0
    assert [row["kind"] for row in json.loads(capsys.readouterr().out)] == ["began", "lesson"]
    assert run_command_line(["kb", "diff", "0", "1", "--kb", str(folder)]) == 0
    assert "cube" in capsys.readouterr().out
    assert run_command_line(["kb", "rollback", "0", "--kb", str(folder)]) == 0
    assert run_command_line(["kb", "show", "--store", str(folder)]) == 0
    assert len(capsys.readouterr().out.splitlines()) >= 116


def test_learning_says_what_it_cannot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file instead of a folder, a server beside a folder, another embedder's entries, a damaged journal: one
    line, exit 2 or 3."""
    file = tmp_path / "kb.jsonl"
    file.write_text("x")
    foreign = tmp_path / "foreign.jsonl"
    make_store(path=foreign)
    for words, code in (
        (["--kb", str(foreign)], 3),
        (["--learn", "--kb", str(file)], 2),
        (["--learn", "--kb-url", "http://127.0.0.1:1"], 2),
        (["--kb", str(tmp_path / "none.jsonl")], 2),
        (["--kb", str(tmp_path)], 2),
        (["--embedder", "eyes"], 2),
        (["--embedder", f"clip:{tmp_path}/none.safetensors"], 2),
    ):
        assert run_command_line(["run", WORDS, "--dry-run", *words]) == code
        assert capsys.readouterr().err.count("\n") == 1
    LearnedBase.begin(tmp_path / "kb")
    (tmp_path / "kb" / "journal.jsonl").write_text("rubbish\n")
    with pytest.raises(EnvironmentFaultError, match="damaged"):
        session(tmp_path / "kb")


def test_a_folder_learns_with_the_embedder_it_began_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Begun with another embedder, the folder's entries have its vectors; a session with the usual one is refused in one
    line that names the mend, and the folder stays as it was."""
    monkeypatch.setenv("RAGVLM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(
        "kb.open_embedder.open_embedder", lambda word="": MeanColour() if word == "other" else ShapeColourEmbedder()
    )
    folder = tmp_path / "kb"
    asked = {"scene": "single_cube", "evaluator": "analytic", "perception": "oracle", "kb": str(folder), "learn": True}
    store = Learner(RunOptions(**asked, embedder="other")).store
    assert (store.embedder_name, len(store), store.header.dim) == ("mean-colour", 116, 3)
    before = [(file.name, file.read_bytes()) for file in sorted(folder.iterdir())]
    assert run_command_line(["run", WORDS, "--dry-run", "--learn", "--kb", str(folder)]) == 3
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "learns with the embedder 'mean-colour', the session uses 'shape-colour-1'; use that embedder" in said
    assert [(file.name, file.read_bytes()) for file in sorted(folder.iterdir())] == before


def test_teaching_what_is_not_there_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An object that the scene lacks is refused with the scene's own ones before a knowledge base is begun."""
    folder = tmp_path / "kb"
    assert run_command_line(["kb", "add", "die", "--scene", "single_cube", "--object", "x", "--kb", str(folder)]) == 2
    assert "(valid: cube)" in capsys.readouterr().err
    assert not folder.exists()


def test_a_query_needs_a_category(capsys: pytest.CaptureFixture[str]) -> None:
    """An empty category is refused; it would otherwise be asked as one that nothing has."""
    assert run_command_line(["kb", "query", " "]) == 2
    assert "CATEGORY" in capsys.readouterr().err


@pytest.mark.long
def test_an_object_is_taught(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`kb add` grasps the object ten times and adds at least one entry of its name; a second time it gets another id."""
    folder = tmp_path / "kb"
    words = ["kb", "add", "die", "--scene", "single_cube", "--object", "cube", "--kb", str(folder)]
    assert run_command_line(words) == 0
    assert run_command_line(words) == 0
    taught = [entry for entry in LearnedBase.open(folder).store().all() if entry.category == "die"]
    assert len(taught) >= 2
    assert sum(entry.n_trials for entry in taught) <= 20
    assert "succeeded" in capsys.readouterr().out


@pytest.mark.long
def test_the_quick_evaluation_of_the_command_line(tmp_path: Path) -> None:
    """`kb eval --quick` on the twelve objects writes the promised JSON, the tables and the page."""
    file, out = tmp_path / "numbers.json", tmp_path / "report"
    words = ["kb", "eval", "--quick", "--splits", "in", "--json", str(file), "--out", str(out)]
    assert run_command_line(words) == 0
    found = json.loads(file.read_text())
    assert found["queries"] == 12
    assert found["systems"]["haa"]["p_at_1"] >= 0.9
    assert {"p_at_1", "p_at_3", "mrr", "affordance_match", "r_func_p_at_1"} <= set(found["systems"]["oracle"])
    assert (out / "report.html").read_text().count("<svg") >= 3
    assert "HAA" in (out / "tables.md").read_text()
