"""The chat behind a name of `--brain`, with a record around it where one is wanted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from agent.brains.chat import Chat
from agent.draws import draws
from kb.errors import BadInputError

NAMES = ("rules", "openai:MODEL", "hf:MODEL_OR_FOLDER", "replay:FILE")


def chat_named(
    name: str,
    base_url: str | None = None,
    *,
    seed: int = 0,
    record: str | Path | None = None,
    pictures: bool = True,
    stopped: Callable[[], bool] = lambda: False,
) -> Chat:
    """The chat of that name.

    Args:
        name: "openai:MODEL", "hf:FOLDER" or "replay:FILE".
        base_url: server of "openai:".
        seed: waits between trials follow from it.
        record: file in which exchanges are kept; what stands in it already is not asked again.
        pictures: whether pictures are sent.
        stopped: whether a person wants everything to end.

    Raises:
        BadInputError: unknown name, or a record that cannot be read.
        EnvironmentFaultError: what the chat needs is not there.
    """
    from agent.brains.recorded import RecordingChat, ReplayChat

    kind, _, what = name.partition(":")
    if kind not in ("openai", "hf", "replay") or not what:
        raise BadInputError(f"unknown brain {name!r}", choices=NAMES)
    if kind == "replay":
        return ReplayChat(Path(what))
    if kind == "openai":
        from agent.brains.openai_chat import OpenAIChat

        chat: Chat = OpenAIChat(what, base_url, rng=draws(seed, "back off", 0), sees=pictures, stopped=stopped)
    else:
        from agent.brains.hf_chat import open_hf_chat

        chat = open_hf_chat(what, sees=pictures, stopped=stopped)
    return chat if record is None else RecordingChat(chat, Path(record))
