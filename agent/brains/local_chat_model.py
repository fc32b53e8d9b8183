"""The model in this process as a chat model of LangChain, for whoever composes with it: invoked, or streamed piece by piece.

The brain itself asks `HfChat` directly: what a model says counts only as a whole, after the gate.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from typing import Any, Literal

from langchain_core.callbacks import CallbackManagerForLLMRun
from langchain_core.language_models.chat_models import BaseChatModel
from langchain_core.messages import AIMessageChunk, BaseMessage
from langchain_core.messages.ai import UsageMetadata
from langchain_core.outputs import ChatGenerationChunk, ChatResult
from pydantic import Field

from agent.brains.chat import Message, Prompt, Reply, Role
from agent.brains.hf_chat import HfChat
from kb.errors import BadInputError

ROLES: dict[str, Role] = {"system": "system", "human": "user"}


class LocalChatModel(BaseChatModel):
    """Sends messages of LangChain to a loaded model."""

    chat: Any
    """A `HfChat`."""
    reply_schema: dict[str, Any] = Field(default_factory=dict)
    """JSON schema that every reply is bound to; empty is free text."""
    max_tokens: int = 512
    seconds: float = 120.0
    """Time for one reply [s]."""

    @property
    def _llm_type(self) -> str:
        return "ragvlm-hf"

    @property
    def _identifying_params(self) -> dict[str, Any]:
        return {"model": self.chat.name, "reply_schema": self.reply_schema, "max_tokens": self.max_tokens}

    def _prompt(self, messages: list[BaseMessage]) -> Prompt:
        sent = tuple(_message(message) for message in messages)
        return Prompt("chat", sent, self.reply_schema, self.max_tokens, self.seconds)

    def _generate(
        self,
        messages: list[BaseMessage],
        stop: list[str] | None = None,
        run_manager: CallbackManagerForLLMRun | None = None,
        **kwargs: Any,
    ) -> ChatResult:
        from langchain_core.language_models.chat_models import generate_from_stream

        return generate_from_stream(self._stream(messages, stop, None, **kwargs))

    def _stream(
        self,
        messages: list[BaseMessage],
        stop: list[str] | None = None,
        run_manager: CallbackManagerForLLMRun | None = None,
        **kwargs: Any,
    ) -> Iterator[ChatGenerationChunk]:
        """The reply piece by piece; the last chunk is empty and counts the tokens.

        Raises:
            BadInputError: options or messages that this model has no use for.
            BrainFaultError: the time is over, or the person has stopped.
        """
        if stop or kwargs:
            given = ", ".join(sorted([*kwargs, *(["stop"] if stop else [])]))
            raise BadInputError(f"{given}: a reply ends by its schema or its length", where="LocalChatModel")
        chat: HfChat = self.chat
        stream = chat.stream(self._prompt(messages))
        try:
            while True:
                try:
                    piece = next(stream)
                except StopIteration as end:
                    yield _last(end.value)
                    return
                chunk = ChatGenerationChunk(message=AIMessageChunk(content=piece))
                if run_manager is not None:
                    run_manager.on_llm_new_token(piece, chunk=chunk)
                yield chunk
        finally:
            stream.close()


def _last(reply: Reply) -> ChatGenerationChunk:
    used = UsageMetadata(
        input_tokens=reply.prompt_tokens,
        output_tokens=reply.completion_tokens,
        total_tokens=reply.prompt_tokens + reply.completion_tokens,
    )
    return ChatGenerationChunk(message=AIMessageChunk(content="", usage_metadata=used, chunk_position="last"))


def _message(message: BaseMessage) -> Message:
    """A message of ours.

    Raises:
        BadInputError: neither a system nor a human message, or a part that is neither text nor a picture with its bytes.
    """
    if message.type not in ROLES:
        raise BadInputError(f"a message of type {message.type!r}", where="LocalChatModel", choices=tuple(ROLES))
    texts: list[str] = []
    pictures: list[bytes] = []
    for part in message.content_blocks:
        kind: Literal["text", "image"] | str = part["type"]
        encoded = part.get("base64")
        if kind == "text":
            texts.append(str(part.get("text", "")))
        elif kind == "image" and isinstance(encoded, str):
            pictures.append(base64.b64decode(encoded))
        else:
            raise BadInputError(
                f"a part of type {kind!r}", where="LocalChatModel", choices=("text", "image as base64 data")
            )
    return Message(ROLES[message.type], "\n".join(texts), tuple(pictures))
