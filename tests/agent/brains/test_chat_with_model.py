"""A conversation with a language model: it reads what is said, through the gate, and the rules are the labelled way back."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from agent.brains.chat import Prompt
from agent.brains.model import ModelBrain
from agent.chat.conversation import Conversation
from agent.events import BaseStep
from tests.brain_fixtures import GOOD, ScriptedChat, understand

PICK = understand({"action": "pick", "thing": "the cube"})


def talking(reading: Callable[[Prompt], str]) -> tuple[Conversation, ScriptedChat]:
    """A conversation about a cube, and the chat whose "understand" is `reading`."""
    chat = ScriptedChat(lambda prompt, _n: reading(prompt) if prompt.role == "understand" else GOOD[prompt.role])
    opened = Conversation.open("single_cube", 10_003, brain=ModelBrain(chat), perception="oracle", evaluator="analytic")
    return opened, chat


@pytest.fixture(scope="module")
def obliging() -> Iterator[tuple[Conversation, ScriptedChat]]:
    """A model that takes everything for a wish for the cube."""
    conversation, chat = talking(lambda _prompt: PICK)
    with conversation:
        yield conversation, chat


def kinds(steps: list[BaseStep]) -> list[Any]:
    """The kinds of the steps."""
    return [getattr(step, "kind", "") for step in steps]


def test_the_model_reads_what_the_grammar_cannot(obliging: tuple[Conversation, ScriptedChat]) -> None:
    """A wording that the rules refuse is read by the model, and done."""
    conversation, chat = obliging
    steps = list(conversation.say("kindly hoist that cube skyward, dear machine"))
    assert [prompt.role for prompt in chat.prompts] == ["understand", "think"]
    assert kinds(steps).count("model_call") == 2
    assert conversation.result is not None
    assert conversation.result.success
    assert conversation.result.model_use.fallbacks == ()


def test_what_is_on_record_needs_no_reading(obliging: tuple[Conversation, ScriptedChat]) -> None:
    """What "again" means is on record: the model thinks about the grasp, and reads nothing."""
    conversation, chat = obliging
    before = len(chat.prompts)
    list(conversation.say("do that again but gentler"))
    assert [prompt.role for prompt in chat.prompts[before:]] == ["think"]
    assert conversation.result is not None
    assert conversation.result.success


def test_a_question_moves_nothing(obliging: tuple[Conversation, ScriptedChat]) -> None:
    """Asked what is held, this model says "pick": refused each time, then the rules answer, and say so."""
    conversation, chat = obliging
    before = len(chat.prompts)
    steps = list(conversation.say("what do you see on the table?"))
    assert conversation.result is not None
    assert not conversation.result.executed
    assert kinds(steps).count("reply_refused") == 4
    assert [prompt.role for prompt in chat.prompts[before:]][:4] == ["understand"] * 4
    assert conversation.result.model_use.fallbacks[0].startswith("understand: 4 replies were refused")


def test_the_way_back_is_the_rules_and_says_so() -> None:
    """A model that talks of something absent is refused four times with the reason; the rules read the words, and the
    result and the answer tell it."""
    conversation, chat = talking(lambda _prompt: understand({"action": "pick", "thing": "the dragon"}))
    with conversation:
        steps = list(conversation.say("pick up the cube"))
        result = conversation.result
    assert result is not None
    assert result.success
    assert kinds(steps).count("fallback") == 1
    assert "did not speak of a dragon" in chat.prompts[3].messages[1].text
    assert result.model_use.fallbacks[0].startswith("understand")
    assert "rules decided" in result.answer
