"""`ragvlm chat`, writing down when the arm moves and when it stands still: what `bench.chat_report` measures with.

    RAGVLM_HALTS=FILE python -m bench.timed_chat --scene single_cube

Each line of the file is a word and a wall time [ns]: `moves` where a phase of a motion begins, `ended` where it ends, be it
by a stop. The chat itself is the one of `python -m app chat`.
"""

from __future__ import annotations

import os
import runpy
import sys
import time
from pathlib import Path

from kb.sensing import Phase
from sim.motion_run import Array, Check, MotionRun
from sim.recording import Recording


def main() -> None:
    """Chats, with a clock at both ends of every phase."""
    path, run = Path(os.environ["RAGVLM_HALTS"]), MotionRun.run

    def note(word: str) -> None:
        now = time.time_ns()
        with path.open("a", encoding="utf-8") as file:
            file.write(f"{word} {now}\n")

    def timed_run(self: MotionRun, controls: Array, phase: Phase, check: Check | None = None) -> Recording:
        note("moves")
        try:
            return run(self, controls, phase, check)
        finally:
            note("ended")

    MotionRun.run = timed_run
    sys.argv = ["ragvlm", "chat", *sys.argv[1:]]
    runpy.run_module("app", run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
