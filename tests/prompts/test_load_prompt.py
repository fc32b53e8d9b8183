"""Prompts are files, rendered strictly."""

from __future__ import annotations

from pathlib import Path

import pytest

from prompts import PromptError, load_prompt, placeholders, render

FOLDER = Path(__file__).parents[2] / "prompts"


def test_every_prompt_loads_and_has_plain_placeholders() -> None:
    """Each text file of the room is a prompt with plain names in braces."""
    names = [str(path.relative_to(FOLDER).with_suffix("")) for path in FOLDER.rglob("*.txt")]
    assert names
    for name in names:
        assert all(field.isidentifier() for field in placeholders(load_prompt(name)))


def test_missing_and_superfluous_values_are_errors() -> None:
    """Rendering demands exactly the placeholders."""
    assert "attempt 2" in render("thought/blind", number="2")
    with pytest.raises(PromptError, match="missing"):
        render("thought/blind")
    with pytest.raises(PromptError, match="superfluous"):
        render("thought/blind", number="2", other="x")


@pytest.mark.parametrize("name", ["", "nothing", "../pyproject", "thought/../../README", "/etc/passwd"])
def test_only_prompts_are_read(name: str) -> None:
    """No path leads out of the room."""
    with pytest.raises(PromptError):
        load_prompt(name)


@pytest.mark.parametrize("text", ["{a.b}", "{a[0]}", "{a!r}", "{a:>9}", "{}"])
def test_placeholders_reach_only_their_own_text(text: str) -> None:
    """Attributes, indices, conversions and formats are refused."""
    with pytest.raises(PromptError):
        placeholders(text)
