"""A run in a process of its own that may kill itself (not a test): `killed_run.py THREADS INSTRUCTION KILL_AT`.

KILL_AT: number of the step at whose telling the process dies by SIGKILL, inside the graph's own thread (a listener would race
with a graph that runs ahead of it, and could come after its end), "moved" to die between a motion and its checkpoint, or
"never". Prints the result without timings.
"""

from __future__ import annotations

import os
import queue
import signal
import sys
from typing import Any

import agent.conversation
from agent import build_agent
from agent.events import BaseStep
from agent.world_handle import WorldHandle


def die() -> None:
    """As kill -9 would."""
    os.kill(os.getpid(), signal.SIGKILL)


def die_at(step: int) -> None:
    """Lets the graph's thread die when it tells the step of that number, before its node has ended."""

    class Told(queue.SimpleQueue[Any]):
        count = 0

        def put(self, item: Any, block: bool = True, timeout: float | None = None) -> None:
            if isinstance(item, BaseStep):  # Other parts use such queues too.
                if Told.count == step:
                    die()
                Told.count += 1
            super().put(item, block, timeout)

    agent.conversation.queue.SimpleQueue = Told  # type: ignore[misc]


def main(threads: str, instruction: str, kill_at: str) -> None:
    """Runs (or takes up) the instruction in thread "t"."""
    if kill_at == "moved":
        WorldHandle.moved = lambda self: die()  # type: ignore[method-assign, return-value, assignment]
    if kill_at.isdecimal():
        die_at(int(kill_at))
    robot = build_agent("clear_table", 10_001, perception="oracle", thread="t", threads=threads)
    result = robot.run(instruction)
    print(result.model_dump_json(exclude={"timings_s"}))


if __name__ == "__main__":
    main(*sys.argv[1:])
