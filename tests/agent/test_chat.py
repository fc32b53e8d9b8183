"""The conversation engine: references, demands, steering, what-if, approval, stop."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from agent.chat import Conversation
from agent.chat.hear import hear
from agent.chat.heard import heard, inert
from agent.chat.read_demand import only_demand, plain, read_demand
from agent.state import State


def events(turn: Iterator[Any]) -> dict[str, Any]:
    """The last event of each kind of a turn."""
    return {event.kind: event for event in turn}


def opened(scene: str = "cup_near_vase", **options: Any) -> Conversation:
    """A conversation that is quick: oracle perception, analytic outcomes."""
    return Conversation.open(scene, 10_003, **{"perception": "oracle", "evaluator": "analytic", **options})


@pytest.fixture(scope="module")
def talk() -> Iterator[Conversation]:
    """One conversation that several tests go on with, in order."""
    with opened() as conversation:
        yield conversation


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("no, by the handle", {"region": "handle"}), ("not by the rim", {"not_region": "rim"}), ("gentler", {"force_scale": 0.7}),
        ("from the side please", {"approach": "side"}), ("with 5 N", {"force": 5.0}), ("a bit slower", {"speed_scale": 0.5}),
        ("with a pinch grasp", {"type": "pinch"}), ("opening of 60 mm", {"aperture": 0.06}),
        ("from above and firmer", {"approach": "top", "force_scale": 1.4}),
    ],
)  # fmt: skip
def test_demands_are_read(words: str, wanted: dict[str, Any]) -> None:
    """Each wish becomes the fields it speaks of, and nothing else."""
    demand = only_demand(plain(words))
    assert demand is not None
    assert demand.model_dump(exclude={"words"}, exclude_defaults=True) == wanted


@pytest.mark.parametrize(
    "words", ["pick up the cup", "put it on the side", "the cup with the handle", "sort by size", "why"]
)
def test_what_is_no_demand_is_none(words: str) -> None:
    """Places, things and questions are not taken for a manner."""
    assert read_demand(plain(words))[1] is None


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("gently pick up the cup", {"force_scale": 0.7}), ("pick up the cup slowly, please", {"speed_scale": 0.5}),
        ("please hand me the cup very carefully", {"speed_scale": 0.5}), ("softly take the cup", {"force_scale": 0.7}),
    ],
)  # fmt: skip
def test_a_manner_counts_at_either_end(words: str, wanted: dict[str, Any]) -> None:
    """What is a courtesy to the grammar of orders is a wish in a conversation, and the order stays what it was."""
    (call,) = hear(words, State())
    (demand,) = call.demands
    assert demand.model_dump(exclude={"words"}, exclude_defaults=True) == wanted
    assert "cup" in call.words


def test_tools_are_heard_whatever_the_wording() -> None:
    """Free wording reaches the tool; what is none of them is a task for the brain."""
    for words, tool in (
        ("remember that", "remember"), ("what do you remember?", "recall"), ("compare the last two attempts", "compare"),
        ("what have you done so far?", "report"), ("why did you grasp it that way?", "why"), ("thank you", "say"),
        ("what would have happened with 4 N?", "whatif"), ("what if you had used a pinch grasp", "whatif"),
        ("pick up the cup", "task"), ("what do you see", "task"), ("forget what you remember", "forget"),
        ("forget everything", "forget"), ("forget the phone", "forget"), ("forget about the cup", "forget"),
        ("why did you not use more force?", "why"), ("why did it not work?", "task"),
    ):  # fmt: skip
        assert hear(words, State())[0].tool == tool, words
    assert hear("forget the phone", State())[0].values == {"category": "smartphone"}
    both = hear("pick up the cup and remember that", State())
    assert [call.tool for call in both] == ["task", "remember"]


def test_what_is_heard_is_inert() -> None:
    """Escape sequences, control and direction characters are taken out; words, HTML and line ends in answers stay."""
    assert heard("\x1b[31mred\x1b[0m\x1b]0;t\x07 a\x00b\u202ec\r\nd") == "red abc  d"
    assert inert("<b>a</b>\n\x1b[2Jb") == "<b>a</b>\nb"


def test_references_reach_back(talk: Conversation) -> None:
    """For "it", "the same" and "and the vase?": each turn is about what was spoken of before."""
    assert events(talk.say("pick up the cup"))["finished"].result.goals[0].claimed
    assert talk.state.held is not None
    first = talk.state.attempts[-1].plan.grasp.force
    again = events(talk.say("do that again but gentler"))["finished"].result
    assert [goal.kind for goal in again.goals] == ["place", "pick"]
    assert talk.state.attempts[-1].plan.grasp.force == pytest.approx(0.7 * first, rel=1e-3)
    assert "vase" in events(talk.say("and the vase?"))["answer"].text
    assert talk.state.held.category == "vase"
    assert "vase" in events(talk.say("put it back"))["answer"].text


def test_a_demand_is_a_constraint_with_its_own_provenance(talk: Conversation) -> None:
    """The grasp obeys, and each number it decided names the person's words."""
    events(talk.say("pick up the cup by the rim with 6 N"))
    plan = talk.state.attempts[-1].plan
    assert plan.region == "rim"
    assert plan.grasp.force == 6.0
    said = [item.id for item in plan.provenance["force"] if item.source == "constraint"]
    assert any(item.startswith("person") for item in said)
    events(talk.undo())


def test_what_cannot_be_done_as_demanded_is_not_done_otherwise(talk: Conversation) -> None:
    """A vase has no handle: the robot says so and moves nothing."""
    attempts = len(talk.state.attempts)
    told = events(talk.say("pick up the vase by the handle"))
    assert not told["finished"].result.success
    assert "as you said" in told["finished"].result.answer
    assert len(talk.state.attempts) == attempts


def test_why_and_compare_speak_from_the_record(talk: Conversation) -> None:
    """Every number of the grasp is listed with sources; experiences with their outcomes; two attempts differ by fields."""
    told = events(talk.why())["explained"]
    fields = {fact.field for fact in told.facts}
    assert fields == set(talk.state.attempts[-1].plan.provenance)
    assert all(fact.sources for fact in told.facts)
    assert "trials succeeded" in told.text
    rows = {row.field for row in events(talk.compare(0, 1))["compared"].rows}
    assert "force" in rows
    many = len(talk.state.attempts)
    assert f"I have attempts 1 to {many} of" in events(talk.why(99))["answer"].text
    assert f"I have attempts 1 to {many} of" in events(talk.compare(0, 98))["answer"].text
    assert "object" not in rows


def test_a_what_if_leaves_the_world_alone(talk: Conversation) -> None:
    """The simulated ending is told beside the real one, and the snapshot of the world is the same afterwards."""
    before = talk.state.world
    told = events(talk.whatif(force=1.0))["whatif"]
    assert told.real is not None
    assert told.simulated is not None
    assert told.simulated.claimed is False
    assert talk.state.world == before
    assert events(talk.whatif(force=300.0))["refused"].code == 2
    assert events(talk.whatif(colour="red"))["refused"].code == 2
    assert "no grasp" in events(talk.whatif(region="stem"))["whatif"].text


def test_approval_waits_and_is_steered() -> None:
    """Nothing moves until the word; a question is answered, a wish plans anew, no ends it."""
    with opened(asks=True) as talk:
        assert "asked" in events(talk.say("pick up the cup"))
        assert "noted" in events(talk.say("what do you see?"))
        assert "explained" in events(talk.say("why?"))
        assert events(talk.say("no, by the rim"))["asked"].plan.region == "rim"
        assert not talk.state.executed
        assert events(talk.edit(force=500.0))["refused"].code == 2
        told = events(talk.edit(force=7.0))
        assert told["action"].plan.grasp.force == 7.0
        assert "asked" in events(talk.say("pick up the vase")) or talk.pending is not None
        assert not events(talk.say("no"))["finished"].result.success
        assert talk.pending is None
        assert "refused" in events(talk.approve())


def test_a_placing_is_approved_too() -> None:
    """Nothing is put down without the word: the place is told, questions wait, another place or point is asked about."""
    with opened("single_cube", asks=True) as talk:
        assert events(talk.say("put the cube on the left"))["asked"].motion == "grasp"
        asked = events(talk.approve())["asked"]
        assert (asked.motion, asked.text) == ("place", "May I put the cube on the left?")
        assert asked.point[1] < -0.05  # the person's left is the robot's right
        motions = talk.agent.opened.motions
        assert "because you asked" in events(talk.say("why?"))["noted"].text
        assert "noted" in events(talk.say("gentler"))
        assert events(talk.say("no, on the right"))["asked"].point[1] > 0.05
        assert events(talk.edit(x=2.0))["refused"].code == 2
        assert events(talk.edit(force=5.0))["refused"].code == 2
        assert talk.agent.opened.motions == motions
        done = events(talk.edit(x=0.45, y=0.1))
        assert done["finished"].result.success
        assert done["observation"].sensing.aimed_at == pytest.approx((0.45, 0.1), abs=0.02)
        events(talk.say("pick up the cube"))
        events(talk.approve())
        assert events(talk.undo())["asked"].motion == "place"
        assert not events(talk.reject())["finished"].result.success
        assert talk.state.held is not None


def test_steering_is_heard_before_the_next_motion() -> None:
    """A word that comes while the robot works changes the grasp; something else is done afterwards."""
    with opened() as talk:
        turn = talk.say("pick up the cup")
        told = {}
        for event in turn:
            first = event.kind not in told
            told.setdefault(event.kind, event)
            if event.kind == "look" and first:
                talk.steer("no, by the rim")
                talk.steer("what are you holding?")
        assert "heeded" in told
        assert talk.state.attempts[-1].plan.region == "rim"
        assert ("person", "what are you holding?") in talk.messages
        assert "hand" in talk.messages[-1][1] or "hold" in talk.messages[-1][1]


def test_a_stop_latches() -> None:
    """After a stop nothing moves until the release, whatever is said; then it goes on."""
    with opened() as talk:
        talk.stop()
        told = events(talk.say("pick up the cup"))
        assert "stopped" in told
        assert not told["finished"].result.executed
        talk.release()
        assert events(talk.say("go on"))["finished"].result.success
