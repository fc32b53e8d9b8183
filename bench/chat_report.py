"""Measures the conversation as a person has it and prints the table of docs/chat.md, on a machine that is quiet.

    python -m bench.chat_report                  # everything (about half an hour)
    python -m bench.chat_report --stops 20 --commands 100 --only stop_page,turns

What it measures is wall time through the real faces: keys on a terminal, orders through the page's channel.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.chat_faces import PROMPT, Browser, PageChat, PtyChat, cpu_seconds, resident_mb
from bench.terminal_stops import TerminalStops
from kb.errors import BadInputError

SCENE = ("--scene", "single_cube", "--seed", "10001")
IDLE_S = 20.0
"""How long an idle server is watched [s]."""
ROUND = (
    ("pick up the cube", r"Answer +"), ("/why", r"Why +"), ("what do you see", r"Answer +"), ("put it back", r"Answer +"),
)  # fmt: skip
"""What is said over and over while memory is watched, and what shows that it was answered."""


@dataclass(frozen=True)
class Line:
    """One row of the table."""

    what: str
    measured: str
    target: str
    kept: bool | None
    """None where it could not be measured here."""


def quantile(values: Sequence[float], share: float) -> float:
    """The value below which a share of the values lies."""
    return float(np.quantile(np.asarray(values, float), share))


# Stop ------------------------------------------------------------------------------------------------------------------


def stop_page(stops: int) -> list[Line]:
    """From the page's order to the halt of physics, at random moments of motions in real time."""
    rng, taken = np.random.default_rng(1), list[float]()
    with tempfile.TemporaryDirectory() as home:
        page = PageChat(Path(home), *SCENE)
        try:
            page.order(type="speed", value=1)
            missed = 0
            while len(taken) < stops and missed < 3 * stops + 10:
                found = _stop_page_once(page, float(rng.uniform(0.05, 6.0)))
                if found is None:  # thrown about, the cube may have come to lie where it cannot be taken
                    missed += 1
                    page.order(type="scene", name="single_cube", seed=10001 + missed)
                    page.expect(lambda m: m["type"] == "hello")
                    _ready(page)
                else:
                    taken.append(found)
        finally:
            page.close()
    return [_stop_line("stop from the page", taken)]


def _stop_page_once(page: PageChat, wait: float) -> float | None:
    """Milliseconds, or None where nothing was moving at that moment."""
    if not _moves(page, "pick up the cube"):  # it is in the hand already
        _moves(page, "put it back")
    page.idle(wait)
    at = time.time()
    page.order(type="stop")
    halted: float | None = None

    def over(message: dict[str, Any]) -> bool:
        nonlocal halted
        status = message.get("status", {})
        halted = status.get("halted_at") or halted
        return message["type"] == "status" and status["stopped"] and not status["busy"]

    page.expect(over)
    page.order(type="release")
    page.expect(lambda m: m["type"] == "status" and not m["status"]["stopped"])
    return None if halted is None or halted < at else (halted - at) * 1000


def _moves(page: PageChat, words: str) -> bool:
    """Says something; whether a motion began before the turn was over."""
    page.order(type="say", text=words)
    at_work = False

    def told(message: dict[str, Any]) -> bool:
        nonlocal at_work
        busy = message["status"]["busy"] if message["type"] == "status" else at_work
        over, at_work = at_work and not busy, busy
        return over or (message["type"] == "entry" and message["entry"]["kind"] == "action")

    return page.expect(told)["type"] == "entry"


def _ready(page: PageChat) -> None:
    page.expect(lambda m: m["type"] == "status" and not m["status"]["busy"])


def stop_terminal(stops: int) -> list[Line]:
    """From the key Ctrl-C to the halt of physics, at random moments; moments in which nothing moved don't count."""
    taken, missed = list[float](), 0
    with tempfile.TemporaryDirectory() as folder:
        chat = PtyChat(
            Path(folder), *SCENE, "--perception", "oracle", "--thread", "t", program=("bench.timed_chat",)
        )  # fmt: skip
        try:
            face = TerminalStops(chat, np.random.default_rng(2))
            while len(taken) < stops and missed < 3 * stops + 10:
                found = face.once()
                taken += [] if found is None else [found]
                missed += found is None
        finally:
            chat.close()
    return [_stop_line("stop by Ctrl-C in the terminal", taken)]


def _stop_line(what: str, taken: list[float]) -> Line:
    if not taken:
        return Line(what, "no motion was hit", "p99 at most 50 ms", None)
    p99 = quantile(taken, 0.99)
    measured = (
        f"median {statistics.median(taken):.0f} ms, p99 {p99:.0f} ms, largest {max(taken):.0f} ms ({len(taken)} stops)"
    )
    return Line(what, measured, "p99 at most 50 ms", p99 <= 50.0)


# Turns -----------------------------------------------------------------------------------------------------------------


def turns(count: int) -> list[Line]:
    """The first word after Enter, and what a turn takes beyond perception and motion."""
    first: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        chat = PtyChat(home, *SCENE, "--thread", "t")
        try:
            chat.expect(PROMPT)
            for number in range(count):
                chat.press("pick up the cube" if number % 2 == 0 else "put it back")
                chat.idle(0.2)
                at = time.monotonic()
                chat.press("\r")
                chat.expect(r"Goal +")
                first.append((time.monotonic() - at) * 1000)
                chat.expect(rf"Answer +[\s\S]*?{PROMPT}")
            chat.type(f"/save {home / 'turns.json'}")
            chat.expect(r"results in")
            results = json.loads((home / "turns.json").read_text(encoding="utf-8"))
        finally:
            chat.close()
    times = [result["timings_s"] for result in results]
    stages = ("perception", "retrieval", "planning", "execution", "brain")
    beyond = [(t["total"] - t["perception"] - t["execution"]) * 1000 for t in times]
    idle = [(t["total"] - sum(t[stage] for stage in stages)) * 1000 for t in times]
    planning = [t["planning"] * 1000 for t in times]
    return [
        Line(
            "first streamed word after Enter",
            f"median {statistics.median(first):.0f} ms, largest {max(first):.0f} ms ({count} turns)",
            "at most 300 ms",
            max(first) <= 300.0,
        ),
        Line(
            "a turn beyond perception and motion (planning in it)",
            f"median {statistics.median(beyond):.0f} ms, p95 {quantile(beyond, 0.95):.0f} ms; planning alone "
            f"{statistics.median(planning):.0f} ms, p95 {quantile(planning, 0.95):.0f} ms",
            "at most 150 ms",
            quantile(beyond, 0.95) <= 150.0,
        ),
        Line(
            "the conversation itself: graph, checkpoints, printing",
            f"median {statistics.median(idle):.0f} ms, p95 {quantile(idle, 0.95):.0f} ms",
            "at most 150 ms",
            quantile(idle, 0.95) <= 150.0,
        ),
    ]


# Idle and long ---------------------------------------------------------------------------------------------------------


def idle(_count: int) -> list[Line]:
    """CPU of the server while a page is open and nothing happens; with a browser where there is one."""
    with tempfile.TemporaryDirectory() as home:
        page = PageChat(Path(home), *SCENE)
        try:
            with Browser(page.address) as name:
                page.idle(5.0)
                before, at = cpu_seconds(page.process.pid), time.monotonic()
                page.idle(IDLE_S)
                share = (cpu_seconds(page.process.pid) - before) / (time.monotonic() - at)
        finally:
            page.close()
    return [Line(f"idle server with one page open ({name})", f"{share:.1%} of a core", "at most 20 %", share <= 0.2)]


def memory(commands: int) -> list[Line]:
    """Resident memory of one conversation from its 40 % to its end."""
    sizes: dict[int, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        chat = PtyChat(Path(folder), *SCENE, "--perception", "oracle", "--thread", "t")
        try:
            chat.expect(PROMPT)
            for number in range(commands):
                words, answered = ROUND[number % len(ROUND)]
                chat.type(words)
                chat.expect(answered)
                chat.expect(PROMPT)
                chat.text, chat._seen = "", 0
                if number + 1 in (2 * commands // 5, commands):
                    sizes[number + 1] = resident_mb(chat.process.pid)
        finally:
            chat.close()
    (early, first), (late, last) = sorted(sizes.items())
    grown = last / first - 1
    measured = f"{first:.0f} MB after {early}, {last:.0f} MB after {late}: {grown:+.1%}"
    return [Line(f"memory over {commands} commands", measured, "within 5 %", abs(grown) <= 0.05)]


SECTIONS: dict[str, Callable[[int], list[Line]]] = {
    "stop_page": stop_page, "stop_terminal": stop_terminal, "turns": turns, "idle": idle, "memory": memory,
}  # fmt: skip


def table(lines: Sequence[Line]) -> str:
    """Markdown."""
    marks = {True: "kept", False: "**missed**", None: "not measured"}
    rows = [f"| {line.what} | {line.measured} | {line.target} | {marks[line.kept]} |" for line in lines]
    return "\n".join(["| what | measured | target | |", "|---|---|---|---|", *rows])


def main(arguments: Sequence[str] | None = None) -> int:
    """Measures and prints; 1 if a target was missed."""
    parser = argparse.ArgumentParser(prog="python -m bench.chat_report", description=__doc__)
    parser.add_argument("--stops", type=int, default=200, help="stops through each face")
    parser.add_argument("--turns", type=int, default=30, help="turns timed")
    parser.add_argument("--commands", type=int, default=500, help="commands over which memory is watched")
    parser.add_argument("--only", default=",".join(SECTIONS), help="sections, separated by commas")
    given = parser.parse_args(arguments)
    names = given.only.split(",")
    if unknown := [name for name in names if name not in SECTIONS]:
        raise BadInputError(f"there is no section {unknown[0]!r}", where="--only", choices=SECTIONS)
    counts = {"stop_page": given.stops, "stop_terminal": given.stops, "turns": given.turns, "memory": given.commands}
    lines: list[Line] = []
    for name in names:
        lines += SECTIONS[name](counts.get(name, 0))
    sys.stdout.write(table(lines) + "\n")
    return int(any(line.kept is False for line in lines))


if __name__ == "__main__":
    raise SystemExit(main())
