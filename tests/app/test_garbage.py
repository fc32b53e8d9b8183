"""Laws of when the interpreter looks for garbage, and of where threads take their memory from."""

from __future__ import annotations

import ctypes
import gc
import subprocess
import sys
import weakref
from pathlib import Path

import pytest

from app.garbage import Garbage

ARENAS = """
import ctypes, sys, threading
from app.garbage import Garbage

if sys.argv[2] == "one":
    Garbage()
wait = threading.Barrier(5)
def work():
    kept = [bytearray(5_000) for _ in range(200)]
    wait.wait()
threads = [threading.Thread(target=work) for _ in range(4)]
for thread in threads:
    thread.start()
wait.wait()
library = ctypes.CDLL(None)
library.fopen.restype = ctypes.c_void_p
file = ctypes.c_void_p(library.fopen(sys.argv[1].encode(), b"w"))
library.malloc_info(0, file)
library.fclose(file)
"""
"""Four threads that keep memory at the same time; then the C library tells of its arenas."""


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


@pytest.mark.skipif(getattr(ctypes.CDLL(None), "mallopt", None) is None, reason="not glibc")
def test_threads_take_memory_from_one_place(tmp_path: Path) -> None:
    """Four threads at once have one arena, and several where `Garbage` was not made."""
    arenas: dict[str, int] = {}
    for how in ("one", "many"):
        file = tmp_path / f"{how}.xml"
        subprocess.run([sys.executable, "-c", ARENAS, str(file), how], check=True, cwd=Path(__file__).parents[2])
        arenas[how] = file.read_text(encoding="utf-8").count("<heap nr=")
    assert arenas["one"] == 1
    assert arenas["many"] > 1
