"""Exchanges kept in a file by content hash: recorded while a model replies, and replayed without it.

The same prompt to the same model has the same reply, so all configurations of a benchmark see identical replies, and a
run with a paid model can be repeated for nothing. A file has one JSON object a line.
"""

from __future__ import annotations

import json
import os
import threading
from pathlib import Path
from typing import Any

from agent.brain import BrainFaultError
from agent.brains.chat import Chat, Prompt, Reply
from kb.errors import BadInputError, EnvironmentFaultError

FORMAT = "ragvlm brain record 1"


class RecordingChat:
    """Another chat, whose replies are kept; what is in the file already is not asked again."""

    def __init__(self, chat: Chat, file: Path) -> None:
        """Reads what the file holds, if it is there.

        Raises:
            BadInputError: the file is no record, is one of another model, or cannot be written.
        """
        self._chat, self._file, self._lock = chat, file, threading.Lock()
        self._blind = False
        model, sees, self._known = read_record(file) if file.exists() else (chat.name, chat.sees, {})
        if model != chat.name:
            raise BadInputError(f"{file} holds replies of {model}, not of {chat.name}", where="--record-brain")
        if not file.exists():
            try:
                file.parent.mkdir(parents=True, exist_ok=True)
                with file.open("x", encoding="utf-8") as stream:
                    stream.write(_line({"format": FORMAT, "model": model, "sees": sees}))
            except FileExistsError:  # another process was faster with the very same line
                pass
            except OSError as error:
                raise BadInputError(f"cannot write {file}: {error.strerror}", where="--record-brain") from error

    @property
    def name(self) -> str:
        """That of the model."""
        return self._chat.name

    @property
    def sees(self) -> bool:
        """As the model; a server may turn out not to take pictures, which the record keeps."""
        return self._chat.sees and not self._blind

    def reply(self, prompt: Prompt) -> Reply:
        """The kept reply, or the model's, which is kept; faults are kept for replays, and asked again here.

        Raises:
            BrainFaultError: the model does not reply.
        """
        key = prompt.key(self.name)
        row = self._known.get(key)
        if row is not None and row.get("fault") is None:
            self._blind = not row["sees"]
            return _said(row, prompt)
        try:
            got = self._chat.reply(prompt)
        except BrainFaultError as fault:
            self._keep(key, prompt, {"fault": fault.what})
            raise
        counts = {"prompt_tokens": got.prompt_tokens, "completion_tokens": got.completion_tokens}
        self._keep(key, prompt, {"reply": got.text, **counts})
        return got

    def _keep(self, key: str, prompt: Prompt, outcome: dict[str, Any]) -> None:
        row = {
            "key": key,
            "role": prompt.role,
            "sees": self._chat.sees,
            "messages": [m.record() for m in prompt.messages],
            **outcome,
        }
        with self._lock:
            self._known[key] = row
            # One write at the end of the file: several processes of a benchmark may keep their exchanges in it.
            handle = os.open(self._file, os.O_WRONLY | os.O_APPEND)
            try:
                os.write(handle, _line(row).encode())
            finally:
                os.close(handle)


class ReplayChat:
    """Replies from a record alone; no model is asked."""

    def __init__(self, file: Path) -> None:
        """Reads the record.

        Raises:
            BadInputError: there is no such file, or it is no record.
        """
        self._file = file
        self.model, self.sees, self._known = read_record(file)

    @property
    def name(self) -> str:
        """That of the recorded model: the same prompts have the same keys."""
        return self.model

    def reply(self, prompt: Prompt) -> Reply:
        """The recorded reply, or the recorded fault.

        Raises:
            BrainFaultError: the model did not reply then.
            EnvironmentFaultError: this prompt was never recorded.
        """
        row = self._known.get(prompt.key(self.name))
        if row is None:
            raise EnvironmentFaultError(
                f"{self._file} has no reply to this prompt ({prompt.role})",
                mend=f"record the same command with --brain {self.model} --record-brain {self._file}",
            )
        self.sees = bool(row["sees"])
        if row.get("fault") is not None:
            raise BrainFaultError(str(row["fault"]))
        return _said(row, prompt)


def read_record(file: Path) -> tuple[str, bool, dict[str, dict[str, Any]]]:
    """Model, whether it was sent pictures, and the exchanges by key; a line cut off by a kill is left out.

    Raises:
        BadInputError: the file cannot be read or is no record.
    """
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise BadInputError(
            f"cannot read {file}: {getattr(error, 'strerror', None) or error}", where="brain"
        ) from error
    rows: list[Any] = []
    for number, line in enumerate(lines):
        try:
            rows.append(json.loads(line))
        except ValueError:
            if number == 0:
                break
            if number < len(lines) - 1:
                raise BadInputError(f"{file} line {number + 1} is no JSON", where="brain") from None
    head = rows[0] if rows and isinstance(rows[0], dict) else {}
    if head.get("format") != FORMAT:
        raise BadInputError(f"{file} is no record of a brain (made by --record-brain)", where="brain")
    return str(head["model"]), bool(head["sees"]), {row["key"]: row for row in rows if "key" in row}


def _said(row: dict[str, Any], prompt: Prompt) -> Reply:
    """A kept reply; whoever listens hears it as a whole."""
    prompt.hear(str(row["reply"]))
    return Reply(str(row["reply"]), int(row["prompt_tokens"]), int(row["completion_tokens"]))


def _line(row: dict[str, Any]) -> str:
    return json.dumps(row, sort_keys=True) + "\n"
