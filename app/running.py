"""One run from the command line: checks the targets, streams the steps, writes the result, returns the exit code."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from app.console import make_console
from app.exit_codes import ACHIEVED, INTERRUPTED, NOT_ACHIEVED
from app.files import refuse_unwritable_file, write_atomically
from app.garbage import Garbage
from app.interrupts import StopOnInterrupt
from kb.errors import BadInputError

if TYPE_CHECKING:
    from rich.console import Console

    from app.options import RunOptions
    from app.record import RunRecord
    from app.session import Session
    from kb.run_result import RunResult

MAX_INSTRUCTION = 10_000
"""Characters of an instruction (product contract)."""


def check_instruction(instruction: str) -> str:
    """The instruction without surrounding space.

    Raises:
        BadInputError: empty (characters that cannot be seen count for nothing) or too long.
    """
    from agent.conversation import is_blank

    words = instruction.strip()
    if is_blank(words):
        raise BadInputError("it is empty; say what the robot is to do", where="INSTRUCTION")
    if len(instruction) > MAX_INSTRUCTION:
        raise BadInputError(
            f"it has {len(instruction)} characters", where="INSTRUCTION", choices=(f"1 to {MAX_INSTRUCTION}",)
        )
    return words


def run_once(instruction: str, options: RunOptions) -> int:
    """Runs one instruction and returns the exit code.

    Raises:
        BadInputError: an instruction, scene or target that cannot be used; nothing has moved or been written then.
        EnvironmentFaultError: the machine cannot do it.
    """
    from app.session import Session

    words = check_instruction(instruction)
    console = make_console(stderr=options.json == "-")
    if options.json not in (None, "-"):
        refuse_unwritable_file(Path(str(options.json)), where="--json")
    record = _make_record(options)
    with Session(options) as session:
        Garbage()  # from now on no long search for garbage delays a stop
        if session.unfinished == words:
            console.print(f"going on where thread {options.thread} was interrupted")
        if record is not None:
            record.begin(session.world, session.views)
        with StopOnInterrupt(session.stop, lambda text: print(text, file=sys.stderr)) as guard:
            result = _stream(session, words, console, record)
        _say_end(console, result)
        _save(options, result)
        if record is not None:
            _finish(record, result, console)
    if guard.pressed:
        return INTERRUPTED
    return ACHIEVED if result.success else NOT_ACHIEVED


def _make_record(options: RunOptions) -> RunRecord | None:
    if options.record is None:
        return None
    from app.record import RunRecord

    return RunRecord(Path(options.record))


def _stream(session: Session, words: str, console: Console, record: RunRecord | None) -> RunResult:
    """Prints and records the steps as they happen; returns the result."""
    from agent.events import Saying
    from app.steps import StepPrinter

    printer = StepPrinter(console)
    try:
        for step in session.stream(words):
            printer.show(step)
            # What a model was about to say is no step of the run: its whole reply is one.
            if record is not None and not isinstance(step, Saying):
                record.on_step(step)
    finally:
        printer.end_words()
    return session.result


def _say_end(console: Console, result: RunResult) -> None:
    from app.verdict_block import print_verdict

    print_verdict(console, result)


def _save(options: RunOptions, result: RunResult) -> None:
    """Writes `--json`; on standard output nothing else stands there."""
    from app.record import result_text

    if options.json == "-":
        sys.stdout.write(result_text(result))
        sys.stdout.flush()
    elif options.json is not None:
        write_atomically(Path(options.json), result_text(result))


def _finish(record: RunRecord, result: RunResult, console: Console) -> None:
    """Paints and writes the rest of the record, with progress on a terminal."""
    if console.is_terminal:
        with console.status("writing the record") as status:
            files = record.finish(result, status.update)
    else:
        console.print("writing the record: pictures, then the video")
        files = record.finish(result)
    console.print(f"recorded {len(files)} files in {record.folder}; look again with: ragvlm show {record.folder}")
