"""History H = {(g_r, F_r, Q_r)}: the failed attempts of the current goal, as the agent itself saw them (Algorithm 1)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

from kb.base import Noun
from kb.grasp import Grasp, Quality
from kb.vocabulary import FailureType


class HistoryEntry(Noun):
    """One failed attempt."""

    goal: Annotated[int, Field(ge=0)]
    """Number of the goal within the run."""
    attempt: Annotated[int, Field(ge=0)]
    """r: 0 is the first attempt."""
    grasp: Grasp | None
    """g_r; None if no grasp was found."""
    failure: FailureType
    """F_r, the agent's own diagnosis."""
    quality: Quality | None = None
    """Q_r, as estimated before the attempt."""
    region: str = ""
    candidate: str = ""
    """Name of the candidate that was tried."""
    experiences: tuple[str, ...] = ()
    """Ids of the experiences that were used."""


def merge_history(
    left: tuple[HistoryEntry, ...], right: Iterable[HistoryEntry] | HistoryEntry | None
) -> tuple[HistoryEntry, ...]:
    """Reducer: the union, one entry per (goal, attempt), in order; of two different ones the left stays."""
    if right is None:
        return left
    added = (right,) if isinstance(right, HistoryEntry) else tuple(right)
    union: dict[tuple[int, int], HistoryEntry] = {}
    for entry in (*left, *added):
        union.setdefault((entry.goal, entry.attempt), entry)
    return tuple(union[key] for key in sorted(union))


def of_goal(history: tuple[HistoryEntry, ...], goal: int) -> tuple[HistoryEntry, ...]:
    """The entries of one goal, in the order of the attempts."""
    return tuple(entry for entry in history if entry.goal == goal)


def tried_types(history: tuple[HistoryEntry, ...], goal: int) -> tuple[str, ...]:
    """Grasp types that failed for the goal, each once, in order."""
    types = [entry.grasp.type for entry in of_goal(history, goal) if entry.grasp is not None]
    return tuple(dict.fromkeys(types))
