"""The thin line to a language model: a prompt of messages and pictures with a JSON schema in, a text out.

A chat knows nothing of robots. Everything that a server, a local model or a record of earlier replies has in common is
here; what is asked and what a reply means is `agent.brains.model`'s business.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

from agent.brain import unheard

Role = Literal["system", "user"]


@dataclass(frozen=True)
class Message:
    """One message of a prompt."""

    role: Role
    text: str
    pictures: tuple[bytes, ...] = ()
    """PNG files."""

    def record(self) -> dict[str, Any]:
        """As it stands in records: pictures by content hash."""
        row: dict[str, Any] = {"role": self.role, "text": self.text}
        if self.pictures:
            row["pictures"] = [digest(picture) for picture in self.pictures]
        return row


@dataclass(frozen=True)
class Prompt:
    """One question to a model."""

    role: str
    """What is asked for, as in `agent.brain.Exchange`."""
    messages: tuple[Message, ...]
    schema: dict[str, Any] = field(default_factory=dict)
    """JSON schema of the reply."""
    max_tokens: int = 512
    seconds: float = 120.0
    """Time left for the reply, retries included [s]."""
    hear: Callable[[str], None] = field(default=unheard, compare=False, repr=False)
    """Told the reply so far, each time that more of it has come; after a fault it begins anew."""

    def key(self, model: str) -> str:
        """Content hash: the same model, messages, pictures and schema have the same key."""
        content = [model, self.role, [m.record() for m in self.messages], self.schema, self.max_tokens]
        return digest(json.dumps(content, sort_keys=True).encode())


@dataclass(frozen=True)
class Reply:
    """What a model replied."""

    text: str
    prompt_tokens: int = 0
    completion_tokens: int = 0


class Chat(Protocol):
    """Something that replies to prompts."""

    @property
    def name(self) -> str:
        """As in `--brain`."""
        ...

    @property
    def sees(self) -> bool:
        """Whether pictures can be sent."""
        ...

    def reply(self, prompt: Prompt) -> Reply:
        """The model's reply.

        Raises:
            BrainFaultError: there is none.
        """
        ...


def digest(blob: bytes) -> str:
    """Content hash."""
    return hashlib.blake2b(blob, digest_size=16).hexdigest()
