"""The rooms are what the architecture says: packages of this distribution alone, with words that do not read facts."""

from __future__ import annotations

import ast
import importlib.metadata
import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("agent", "app", "bench", "kb", "memory", "prompts", "sim", "tools")
DISTRIBUTION = "agentic-rag-vlm"
LONGEST_FILE = 520


def sources(room: str) -> list[Path]:
    return sorted((ROOT / room).rglob("*.py"))


@pytest.mark.parametrize("room", ROOMS)
def test_each_room_belongs_to_this_distribution_alone(room: str) -> None:
    """No other installed distribution provides a package of the same name, which would shadow or be shadowed."""
    owners = set(importlib.metadata.packages_distributions().get(room, []))
    # An editable installation lists no files for its packages, so it may be absent from the mapping.
    assert owners <= {DISTRIBUTION}
    assert importlib.metadata.version(DISTRIBUTION)


@pytest.mark.parametrize("room", ROOMS)
def test_each_room_is_imported_from_this_tree(room: str) -> None:
    """The tests test this tree and not an installed copy of it."""
    spec = importlib.util.find_spec(room)
    assert spec is not None
    assert spec.origin is not None
    assert Path(spec.origin).resolve().is_relative_to(ROOT)


def test_words_do_not_load_the_store() -> None:
    """`import kb` gives words only: neither the store nor chromadb, numpy's users or any other room is loaded."""
    code = "import sys, kb; print(*[m for m in sys.modules if m.split('.')[0] in "
    code += (
        "('chromadb', 'mujoco', 'langgraph', 'sim', 'tools', 'agent', 'app') or m in ('kb.store', 'kb.store_file')])"
    )
    loaded = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert loaded.stdout.split() == []


@pytest.mark.parametrize("room", ROOMS)
def test_init_files_only_reexport(room: str) -> None:
    """`__init__` files hold a docstring, imports, `__all__` and lazy re-exports, no logic of their own."""
    for path in sources(room):
        if path.name != "__init__.py":
            continue
        for node in ast.parse(path.read_text()).body:
            lazy = isinstance(node, ast.FunctionDef) and node.name in ("__getattr__", "__dir__")
            words = isinstance(node, ast.Expr | ast.Import | ast.ImportFrom | ast.Assign | ast.AnnAssign | ast.If)
            assert lazy or words, f"{path.relative_to(ROOT)}:{node.lineno}"


@pytest.mark.parametrize("room", ROOMS)
def test_files_are_one_noun_or_verb(room: str) -> None:
    """No catch-all module names, no file longer than a reader can hold."""
    for path in sources(room):
        name = path.relative_to(ROOT)
        assert path.stem not in ("utils", "util", "helpers", "common", "misc"), name
        assert len(path.read_text().splitlines()) <= LONGEST_FILE, name


@pytest.mark.parametrize("room", ROOMS)
def test_only_faces_print(room: str) -> None:
    """`print` stands in the faces alone."""
    if room == "app":
        return
    for path in sources(room):
        calls = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Call)]
        printed = [n.lineno for n in calls if isinstance(n.func, ast.Name) and n.func.id == "print"]
        assert printed == [], path.relative_to(ROOT)


def test_tests_are_no_packages() -> None:
    """Test folders have no `__init__.py`, so equal file names in different folders do not collide."""
    assert list((ROOT / "tests").rglob("__init__.py")) == []
