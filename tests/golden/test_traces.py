"""Whole traces of typed steps, pinned as text with the measured numbers masked.

After a wanted change write them again with

    RAGVLM_WRITE_GOLDEN=1 python -m pytest tests/golden/test_traces.py
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from agent import build_agent, motions
from kb.sensing import Sensing

FOLDER = Path(__file__).parent / "traces"

CONVERSATIONS: dict[str, tuple[str, tuple[str, ...]]] = {
    "pick": ("single_cube", ("pick up the cube",)),
    "miss_then_hold": ("single_cube", ("pick up the cube", "why did it fail?")),
    "put_and_ask": ("single_apple", ("put the apple on the left", "what are you holding?", "undo")),
    "refusals": ("single_apple", ("pick up the teapot", "pour the tea", "help", "stop", "the apple")),
    "support": ("block_on_bowl", ("pick up the bowl",)),
}
"""Name -> scene and what is said."""


def masked(text: str) -> str:
    """The text with every number as "#": physics may be tuned without touching what is said."""
    return re.sub(r"-?\d+(?:\.\d+)?%?", "#", text)


def trace(name: str, monkeypatch: pytest.MonkeyPatch) -> str:
    """The steps of a conversation, one a line."""
    scene, said = CONVERSATIONS[name]
    if name == "miss_then_hold":
        real, calls = motions.execute_grasp, []

        def miss_first(args: object, context: object) -> Sensing:
            calls.append(args)
            nothing = Sensing(phase="close", aperture_start=0.08)
            return nothing if len(calls) == 1 else real(args, context)  # type: ignore[arg-type]

        monkeypatch.setattr(motions, "execute_grasp", miss_first)
    agent = build_agent(scene, 10_001, perception="oracle")
    lines: list[str] = []
    for instruction in said:
        lines.append(f"> {instruction}")
        agent.run(instruction, lambda step: lines.append(masked(str(step))))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("name", CONVERSATIONS)
def test_trace_is_as_pinned(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each conversation tells the same steps in the same words."""
    file = FOLDER / f"{name}.txt"
    now = trace(name, monkeypatch)
    if os.environ.get("RAGVLM_WRITE_GOLDEN"):
        FOLDER.mkdir(exist_ok=True)
        file.write_text(now, encoding="utf-8")
    assert now == file.read_text(encoding="utf-8")
