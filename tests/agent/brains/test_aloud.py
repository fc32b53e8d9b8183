"""What a model says while it says it: told where somebody wants it, inert, and of no effect on what counts."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agent.brains.chat import Message, Prompt, Reply
from agent.brains.model import ModelBrain
from agent.brains.openai_chat import OpenAIChat
from agent.brains.recorded import RecordingChat, ReplayChat
from agent.brains.replies import UnderstandReply, parse
from agent.brains.said_goals import understanding_of
from agent.brains.words import words_so_far
from agent.build_agent import build_agent
from tests.brain_fixtures import GOOD, ScriptedChat, fault_server, think, understand


class StreamingChat(ScriptedChat):
    """Replies letter by letter."""

    def reply(self, prompt: Prompt) -> Reply:
        """The scripted reply, heard while it grows."""
        got = super().reply(prompt)
        for end in range(1, len(got.text) + 1):
            prompt.hear(got.text[:end])
        return got


def steps_of(chat: Any, **options: Any) -> list[Any]:
    """The steps of a run, whose clock goes on by 50 ms at each look."""
    agent = build_agent(
        "single_cube", 10_001, brain=ModelBrain(chat), perception="oracle", evaluator="analytic", **options
    )
    ticks = iter(range(10**9))
    agent.context.clock = lambda: next(ticks) / 20
    return list(agent.stream("pick up the cube"))


@pytest.mark.parametrize(
    ("role", "text", "words"),
    [
        ("think", "", ""),
        ("think", '{"thou', ""),
        ("think", '{"thought": "It sta', "It sta"),
        ("think", '```json\n{"thought": "It stands.", "choice": "act", "question": "', "It stands."),
        ("think", '{"thought": "say \\"yes\\" \\u00e', 'say "yes"'),
        ("think", '{"thought": "back\\', "back"),
        ("think", '{"choice": "act", "thought": "a", "question": "b?"}', "a b?"),
        ("understand", '{"goals": [{"action": "pick", "thing": "the cu', "pick the cu"),
        ("perceive", '{"objects": [{"mark": 1, "category": "cup", "affordance": "x"}, {"category": "va', "cup va"),
        ("answer", '{"text": "I hold it.', "I hold it."),
        ("answer", "Sure! I hold", "Sure! I hold"),
    ],
)
def test_words_are_read_from_a_reply_that_ends_anywhere(role: str, text: str, words: str) -> None:
    """The texts that say something, whatever is missing; a reply that is no JSON is words itself."""
    assert words_so_far(role, text) == words


def test_words_are_bounded_and_grow_only_at_their_end() -> None:
    """Whatever the length, at most 600 characters; what was shown stays the beginning of what is shown next."""
    whole = think(thought="It stands free, so I take it. " * 8)
    shown = [words_so_far("think", whole[:end]) for end in range(len(whole))]
    assert all(after.startswith(before) for before, after in itertools.pairwise(shown))
    assert len(words_so_far("think", "x" * 10_000)) == 600


def test_nobody_hears_a_model_unless_somebody_wants_to() -> None:
    """Without `aloud` the steps are those of a chat that does not stream."""
    plain, streamed = steps_of(ScriptedChat()), steps_of(StreamingChat())
    assert [step.model_dump_json() for step in plain if step.kind != "answer"] == [
        step.model_dump_json() for step in streamed if step.kind != "answer"
    ]
    assert all(step.kind != "saying" for step in streamed)


def test_words_grow_between_the_steps_and_change_nothing() -> None:
    """Aloud, the words of a reply come before it counts, growing, inert, and whole in the end; the other steps are the same,
    those of a refused reply included."""
    evil = think(thought="I\x1b[2J press\u202e hard <b>", force_n=60)
    chats = [
        kind(lambda prompt, n: evil if prompt.role == "think" and n == 1 else GOOD[prompt.role])
        for kind in (ScriptedChat, StreamingChat)
    ]
    quiet, aloud = steps_of(chats[0]), steps_of(chats[1], aloud=True)
    assert [step.kind for step in aloud if step.kind != "saying"] == [step.kind for step in quiet]
    runs: list[list[Any]] = [[]]
    for step in aloud:
        if step.kind == "saying":
            runs[-1].append(step)
        elif runs[-1]:
            assert step.kind == "model_call"
            runs.append([])
    heard = [run for run in runs if run]
    assert [run[-1].text for run in heard] == ["the cube pick", "I press hard <b>", "It stands free."]
    assert all(len(run) > 3 for run in heard)
    assert all(step.text.isprintable() for run in heard for step in run)
    assert all(b.text.startswith(a.text) for run in (heard[0], heard[2]) for a, b in itertools.pairwise(run))
    assert [step.role for step in (run[0] for run in heard)] == ["understand", "think", "think"]


def test_a_stuttered_goal_is_one() -> None:
    """What a model says several times in a row is done once; the same again after something else is another goal."""
    cube, bin_ = (
        {"action": "pick", "thing": "the cube"},
        {"action": "place", "thing": "the cube", "place": "in the bin"},
    )
    for said, kinds in (([cube] * 4, ["pick"]), ([cube, bin_, bin_, cube], ["pick", "place", "pick"])):
        got = understanding_of(parse(understand(*said), UnderstandReply))
        assert [goal.kind for goal in got.goals] == kinds


def test_a_fast_model_does_not_flood() -> None:
    """Within a tenth of a second a reply is told twice at most: its beginning and its end."""
    chat = StreamingChat()
    agent = build_agent("single_cube", 10_001, brain=ModelBrain(chat), perception="oracle", dry_run=True, aloud=True)
    agent.context.clock = lambda: 1.0
    said = [step for step in agent.stream("pick up the cube") if getattr(step, "kind", "") == "saying"]
    assert 2 <= len(said) <= 4


def test_a_servers_stream_is_heard_and_begins_anew_after_a_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each piece of a server is heard with those before it; a trial after a cut reply starts from nothing."""
    monkeypatch.setenv("OPENAI_API_KEY", "sk-none")
    heard: list[str] = []
    with fault_server(("cut", '{"thought": "wrong'), ("ok", GOOD["think"])) as server:
        chat = OpenAIChat("good", server.url, rng=np.random.default_rng(0), sleep=lambda _s: None)
        got = chat.reply(Prompt("think", (Message("user", "x"),), hear=heard.append))
    pieces = [text for text in dict.fromkeys(heard) if text]
    assert pieces == ['{"thought": "wrong', GOOD["think"][: len(GOOD["think"]) // 2], GOOD["think"]]
    assert got.text == GOOD["think"]


def test_a_server_that_says_the_key_is_not_heard_saying_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither the words while they come, cut through the key, nor the whole reply hold it or the half of it."""
    key, heard = "sk-abcdefghij", list[str]()
    monkeypatch.setenv("OPENAI_API_KEY", key)
    before = "so your key is: " + "x" * 7  # the server cuts in the middle of its text
    text = f"{before}{key}{'y' * (len(before) + 1)}"
    assert text[: len(text) // 2].endswith("sk-abcd")
    with fault_server(("ok", text)) as server:
        chat = OpenAIChat("good", server.url, rng=np.random.default_rng(0), sleep=lambda _s: None)
        got = chat.reply(Prompt("think", (Message("user", "x"),), hear=heard.append))
    assert got.text == text.replace(key, "[key]")
    assert before in heard
    assert all("sk-" not in said for said in [*heard, got.text])


def test_a_recorded_reply_is_heard_as_a_whole(tmp_path: Path) -> None:
    """Replayed, a reply is heard once, and a listener does not change what a prompt is known by."""
    file, heard = tmp_path / "brain.jsonl", list[str]()
    prompt = Prompt("think", (Message("user", "x"),))
    listening = Prompt("think", (Message("user", "x"),), hear=heard.append)
    assert prompt.key("scripted") == listening.key("scripted")
    recording = RecordingChat(ScriptedChat(), file)
    recording.reply(prompt)
    for chat in (recording, ReplayChat(file)):
        chat.reply(listening)
    assert heard == [GOOD["think"]] * 2
