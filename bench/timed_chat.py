"""`ragvlm chat`, writing down when the physics stood still after a person's stop: what `bench.chat_report` measures with.

    RAGVLM_HALTS=FILE python -m bench.timed_chat --scene single_cube

Each line of the file is a wall time [ns]. The chat itself is the one of `python -m app chat`.
"""

from __future__ import annotations

import os
import runpy
import sys
import time
from pathlib import Path

from kb.sensing import Phase
from sim.motion_run import MotionRun


def main() -> None:
    """Chats, with a clock at the end of every halt."""
    path, former = Path(os.environ["RAGVLM_HALTS"]), MotionRun.halt

    def halt(self: MotionRun, phase: Phase) -> None:
        former(self, phase)
        if self.stop.pressed:
            now = time.time_ns()
            with path.open("a", encoding="utf-8") as file:
                file.write(f"{now}\n")

    MotionRun.halt = halt
    sys.argv = ["ragvlm", "chat", *sys.argv[1:]]
    runpy.run_module("app", run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
