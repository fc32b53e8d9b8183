"""A run in a process of its own that may kill itself (not a test): `killed_run.py THREADS INSTRUCTION KILL_AT`.

KILL_AT: number of the step at which the process dies by SIGKILL, "moved" to die between a motion and its checkpoint, or
"never". Prints the result without timings.
"""

from __future__ import annotations

import os
import signal
import sys

from agent import build_agent
from agent.world_handle import WorldHandle


def die() -> None:
    """As kill -9 would."""
    os.kill(os.getpid(), signal.SIGKILL)


def main(threads: str, instruction: str, kill_at: str) -> None:
    """Runs (or takes up) the instruction in thread "t"."""
    if kill_at == "moved":
        WorldHandle.moved = lambda self: die()  # type: ignore[method-assign, return-value, assignment]
    agent = build_agent("clear_table", 10_001, perception="oracle", thread="t", threads=threads)
    count = 0
    for _ in agent.stream(instruction):
        if str(count) == kill_at:
            die()
        count += 1
    assert agent.result is not None
    print(agent.result.model_dump_json(exclude={"timings_s"}))


if __name__ == "__main__":
    main(*sys.argv[1:])
