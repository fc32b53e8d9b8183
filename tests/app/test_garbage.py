"""Laws of when the interpreter looks for garbage."""

from __future__ import annotations

import gc
import weakref

from app.garbage import Garbage


class Knot:
    """Refers to itself."""

    def __init__(self) -> None:
        self.me = self


def test_a_full_search_happens_between_turns_only() -> None:
    """However much is made in a turn, no search through everything begins by itself; `collect` finds what was left."""
    former, full = gc.get_threshold(), list[int]()

    def watch(phase: str, info: dict[str, int]) -> None:
        full.extend([info["generation"]] if phase == "start" and info["generation"] == 2 else [])

    try:
        garbage = Garbage()
        gc.callbacks.append(watch)
        knots = [weakref.ref(Knot()) for _ in range(20_000)]
        kept = [[number] for number in range(100_000)]
        assert not full
        last = weakref.ref(Knot())
        garbage.collect()
        garbage.collect()
        assert len(full) == 2
        assert len(kept) == 100_000
        assert all(knot() is None for knot in (*knots, last))
    finally:
        gc.callbacks.remove(watch)
        gc.set_threshold(*former)
        gc.unfreeze()
