"""A reply of the tiny random Qwen3-VL piece by piece: the same text, early pieces, the same limits."""

from __future__ import annotations

import base64
import itertools
import threading
from pathlib import Path
from typing import Any

import pytest

from tests.models.test_hf_brain import folder as folder
from tests.models.test_hf_brain import one_thread as one_thread
from tests.models.test_hf_brain import picture

pytestmark = pytest.mark.models


def asked(kind: Any, text: str = "See?", views: int = 0, tokens: int = 40) -> Any:
    """A prompt with a long beginning, which is kept."""
    from agent.brains.chat import Message, Prompt
    from agent.brains.model import system_prompt
    from agent.brains.replies import schema_of

    system = Message("system", system_prompt("think", kind))
    user = Message("user", text, tuple(picture(number) for number in range(views)))
    return Prompt("think", (system, user), schema_of(kind), tokens, 300.0)


class Door(threading.Event):
    """A model goes through it after each token: slowly while it is shut, which is how its reader keeps up with it."""

    def __init__(self) -> None:
        super().__init__()
        self.set()

    def stopped(self) -> bool:
        """For a chat: nobody stops it."""
        self.wait(0.5)
        return False


def read(stream: Any, told: list[str]) -> Any:
    """The value of the stream after its last piece."""
    try:
        while True:
            told.append(next(stream))
    except StopIteration as end:
        return end.value


@pytest.mark.parametrize("options", ["weights=fp32", "weights=nf4", "weights=bf16&cache=fp8"])
def test_the_pieces_join_to_the_reply(folder: Path, options: str) -> None:
    """Streamed and whole replies are equal, with and without a schema, with several views, after other prompts; the
    beginning of the prompt is computed once for both; a piece comes before the reply is done."""
    from agent.brains.hf_chat import open_hf_chat
    from agent.brains.replies import ThinkReply

    door = Door()
    chat = open_hf_chat(f"{folder}?{options}", stopped=door.stopped)
    for views, bound in ((0, True), (3, True), (1, False)):
        prompt = asked(ThinkReply, views=views)
        if not bound:
            prompt = type(prompt)(prompt.role, prompt.messages, {}, prompt.max_tokens, prompt.seconds)
        whole = chat.reply(prompt)
        door.clear()
        stream = chat.stream(prompt)
        told = [next(stream)]
        assert chat.pace.total_s == 0.0  # set at the end of a reply, which is still being made
        door.set()
        assert read(stream, told) == whole
        assert "".join(told) == whole.text
        assert len(told) > 5
        assert chat.pace.prefilled < 0.5 * whole.prompt_tokens or views > 1
    assert chat.reply(asked(ThinkReply)) == chat.reply(asked(ThinkReply))


def test_a_stream_ends_with_its_reader_its_time_and_the_person(folder: Path) -> None:
    """A reader who leaves ends the reply at the next token; a time that is over and a stop are faults after the pieces
    until then; the next prompt is answered as ever."""
    from agent.brain import BrainFaultError
    from agent.brains.hf_chat import HfChat
    from agent.brains.hf_model import HfCfg, load
    from agent.brains.replies import ThinkReply

    model, processor = load(HfCfg(str(folder), weights="fp32", device="cpu"))
    door = Door()
    chat = HfChat("hf:tiny", model, processor, stopped=door.stopped)
    prompt = asked(ThinkReply, tokens=60)
    whole = chat.reply(prompt)
    door.clear()
    stream = chat.stream(prompt)
    next(stream)
    stream.close()
    door.set()
    assert chat.pace.tokens < whole.completion_tokens
    assert chat.reply(prompt) == whole
    pressed: list[bool] = []
    halting = HfChat("hf:tiny", model, processor, stopped=lambda: bool(pressed))
    stream = halting.stream(prompt)
    next(stream)
    pressed.append(True)
    with pytest.raises(BrainFaultError, match="stopped"):
        list(stream)
    ticks = iter(range(0, 100_000, 30))
    with pytest.raises(BrainFaultError, match="too slow"):
        list(HfChat("hf:tiny", model, processor, clock=lambda: float(next(ticks))).stream(prompt))


def test_the_chat_model_of_langchain_streams_chunks(folder: Path) -> None:
    """The chunks join to the invoked text, which is the brain's; the first one comes before the reply is done; the last one
    counts the tokens; several views go in as one batch; what it does not know is refused."""
    from langchain_core.messages import AIMessage, AIMessageChunk, HumanMessage, SystemMessage

    from agent.brains.hf_chat import open_hf_chat
    from agent.brains.local_chat_model import LocalChatModel
    from agent.brains.replies import ThinkReply, parse, schema_of
    from kb.errors import BadInputError

    door = Door()
    chat = open_hf_chat(f"{folder}?weights=fp32", stopped=door.stopped)
    prompt = asked(ThinkReply, views=2, tokens=700)
    model = LocalChatModel(chat=chat, reply_schema=schema_of(ThinkReply), max_tokens=700, seconds=300.0)
    parts: list[Any] = [{"type": "text", "text": "See?"}]
    for view in prompt.messages[1].pictures:
        url = "data:image/png;base64," + base64.b64encode(view).decode()
        parts.append({"type": "image_url", "image_url": {"url": url}})
    messages = [SystemMessage(prompt.messages[0].text), HumanMessage(content=parts)]
    whole = chat.reply(prompt)
    door.clear()
    stream = model.stream(messages)
    chunks = [next(stream)]
    assert chat.pace.total_s == 0.0
    door.set()
    chunks += stream
    assert all(isinstance(chunk, AIMessageChunk) for chunk in chunks)
    assert len(chunks) > 5
    said = "".join(str(chunk.content) for chunk in chunks)
    assert said == model.invoke(messages).content == whole.text
    assert isinstance(parse(said, ThinkReply), ThinkReply)
    used = chunks[-1].usage_metadata
    assert used is not None
    assert (used["input_tokens"], used["output_tokens"]) == (whole.prompt_tokens, whole.completion_tokens)
    with pytest.raises(BadInputError, match="stop"):
        model.invoke(messages, stop=["x"])
    with pytest.raises(BadInputError, match="type 'ai'"):
        model.invoke([AIMessage("I")])


def test_a_whole_reply_is_heard_while_it_is_made(folder: Path) -> None:
    """Whoever listens to `reply` is told all of it so far after each token that adds to it, the whole in the end, and the
    reply is the one of which nobody heard anything."""
    from dataclasses import replace

    from agent.brains.hf_chat import open_hf_chat
    from agent.brains.replies import ThinkReply

    chat = open_hf_chat(f"{folder}?weights=fp32")
    prompt, heard = asked(ThinkReply), list[str]()
    unfinished: list[bool] = []

    def hear(text: str) -> None:
        heard.append(text)
        unfinished.append(chat.pace.total_s == 0.0)

    assert chat.reply(replace(prompt, hear=hear)) == chat.reply(prompt)
    assert len(heard) > 5
    assert all(unfinished[:-1])
    assert all(after.startswith(before) and after != before for before, after in itertools.pairwise(heard))
    assert heard[-1] == chat.reply(prompt).text
