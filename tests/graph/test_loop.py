"""The whole loop on the real world with oracle perception: order of steps, results, refusals, dry runs, approval."""

from __future__ import annotations

from typing import Any

import pytest

from agent import Agent, build_agent
from agent.events import BaseStep
from kb.errors import BadInputError
from kb.run_result import RunResult


def cube(**options: Any) -> Agent:
    """An agent in front of a single cube."""
    return build_agent("single_cube", 10_001, perception="oracle", **options)


def told(agent: Agent, instruction: str) -> tuple[RunResult, list[BaseStep]]:
    """The result and the steps of one instruction."""
    steps: list[BaseStep] = []
    return agent.run(instruction, steps.append), steps


def test_a_pick_follows_algorithm_1() -> None:
    """Understand, look, ground, retrieve, graph, constraints, plan, Thought, Action, Observation, memory, answer."""
    result, steps = told(cube(), "pick up the cube")
    assert [getattr(s, "kind", "") for s in steps] == [
        "understood", "look", "grounding", "retrieved", "graphed", "constrained", "planned", "thought", "action",
        "observation", "remembered", "answer",
    ]  # fmt: skip
    assert result.success
    assert result.goals[0].claimed
    assert result.goals[0].object == "cube"
    assert result.goals[0].attempts[0].level == 0
    fields = {"position", "approach", "yaw", "aperture", "force", "type"}
    assert fields <= set(result.goals[0].attempts[0].provenance)
    assert result.perception == "oracle"


def test_same_command_same_bytes() -> None:
    """Two runs with one seed give the same JSON apart from timings."""
    one, other = (told(cube(), "hand me the cube")[0].model_dump_json(exclude={"timings_s"}) for _ in range(2))
    assert one == other


def test_a_conversation_goes_on_in_the_same_world() -> None:
    """What is held stays held; "why" is answered from provenance; "what if" is simulated; "it" goes where it is told."""
    agent = cube()
    assert told(agent, "what would have happened with 6 N")[0].success is False
    assert told(agent, "pick up the cube")[0].success
    why = told(agent, "why did you grasp it that way?")[0]
    assert "force" in why.answer
    assert not why.executed
    before = agent.state.world
    what_if = told(agent, "what would have happened with 1 N?")[0]
    assert "Simulated with 1 N" in what_if.answer
    assert agent.state.world == before
    assert "cube" in told(agent, "what are you holding?")[0].answer
    put = told(agent, "put it on the left")[0]
    assert put.success
    assert put.goals[0].verdict is not None
    assert put.goals[0].verdict.placed
    assert "your left" in told(agent, "where is the cube?")[0].answer
    assert told(agent, "what are you holding?")[0].answer == "My hand is empty."


@pytest.mark.parametrize(
    "instruction",
    ["pick up the teapot", "asdf qwer", "nimm den Würfel", "pick up the cube but don't pick it up", "pour tea"],
)
def test_refusals_move_nothing(instruction: str) -> None:
    """What is absent, unintelligible, contradictory or impossible gets an answer and no motion."""
    agent = cube()
    result, steps = told(agent, instruction)
    assert not result.success
    assert not result.executed
    assert result.answer
    assert agent.opened.motions == 0
    assert all(getattr(s, "kind", "") != "action" for s in steps)


def test_bad_instructions_are_bad_input() -> None:
    """Empty and over-long instructions raise before anything happens."""
    agent = cube()
    for text in ("", "  \n", "a" * 10_001):
        with pytest.raises(BadInputError):
            agent.run(text)


def test_a_dry_run_plans_and_moves_nothing() -> None:
    """A dry run finds a grasp, executes none, and is a success."""
    agent = cube(dry_run=True)
    result, _ = told(agent, "put the cube on the left")
    assert result.success
    assert not result.executed
    assert agent.opened.motions == 0


def test_a_rejected_motion_does_not_happen() -> None:
    """Without the person's yes nothing moves; the proposal shows the plan."""
    asked: list[dict[str, Any]] = []

    def reject(proposal: dict[str, Any]) -> dict[str, Any]:
        asked.append(proposal)
        return {"verdict": "reject"}

    agent = cube(approve=reject)
    result, _ = told(agent, "pick up the cube")
    assert asked[0]["plan"]["target"]
    assert not result.executed
    assert not result.success
    assert agent.opened.motions == 0


def test_an_edited_grasp_is_executed_and_says_so() -> None:
    """The person's force is the one that is used, and provenance names the person."""

    def edit(proposal: dict[str, Any]) -> dict[str, Any]:
        return {"verdict": "edit", "grasp": {**proposal["plan"]["grasp"], "force": 9.0}}

    attempt = told(cube(approve=edit), "pick up the cube")[0].goals[0].attempts[0]
    assert attempt.grasp is not None
    assert attempt.grasp.force == 9.0
    assert attempt.provenance["force"][-1].id == "person"


def test_a_stop_before_the_motion_keeps_the_robot_still() -> None:
    """A latched stop ends the goal honestly; after the release the robot moves again."""
    agent = cube()
    agent.stop()
    stopped, _ = told(agent, "pick up the cube")
    assert not stopped.success
    assert not stopped.goals[0].claimed
    agent.release()
    assert told(agent, "pick up the cube")[0].success


def test_an_ambiguous_thing_is_asked_back_and_the_reply_completes_it() -> None:
    """Two cups fit: nothing moves, the question names both; "the red one" then means the red cup."""
    agent = build_agent("repeated_categories", 10_004, perception="oracle")
    first, steps = told(agent, "pick up the cup")
    assert first.question is not None
    assert not first.executed
    assert getattr(steps[-1], "kind", "") == "question"
    colours = [word for word in ("red", "green", "white", "blue", "grey", "yellow", "black") if word in first.question]
    second, _ = told(agent, f"the {colours[0]} one")
    assert second.executed
    assert second.goals[0].kind == "pick"


def test_clearing_handles_every_object() -> None:
    """Clear the table: one place goal per object, all in the bin by the observer's word."""
    result, _ = told(build_agent("clear_table", 10_001, perception="oracle"), "clear the table")
    children = [goal for goal in result.goals if goal.parent == 0]
    assert len(children) == 3
    assert all(goal.verdict is not None and goal.verdict.placed for goal in children)


def test_a_stop_in_the_middle_of_a_motion_ends_the_run_honestly() -> None:
    """Stop while the robot moves: the run ends without a claim; after the release the world goes on from there."""
    agent = cube()

    def stop_on_action(step: BaseStep) -> None:
        if getattr(step, "kind", "") == "action":
            agent.stop()

    stopped = agent.run("pick up the cube", stop_on_action)
    assert not stopped.goals[0].claimed
    assert not stopped.success
    assert "stopped" in stopped.answer.lower()
    agent.release()
    again = told(agent, "pick up the cube")[0]
    assert again.goals[0].claimed


def test_a_release_within_the_stopped_turn_sets_nothing_going() -> None:
    """What was stopped does not go on by itself, however soon the release comes; the next instruction does."""
    agent = cube()

    def stop_and_release(step: BaseStep) -> None:
        if getattr(step, "kind", "") == "action":
            agent.stop()
            agent.release()

    stopped = agent.run("pick up the cube", stop_and_release)
    assert not stopped.goals[0].claimed
    assert len(stopped.goals[0].attempts) == 1
    assert "stopped" in stopped.answer.lower()
    assert not agent.opened.stop.pressed
    assert told(agent, "pick up the cube")[0].goals[0].claimed


def test_a_stop_after_a_release_within_one_turn_holds() -> None:
    """The last word counts: stop, release, stop leaves the robot stopped when the turn has ended."""
    agent = cube()

    def stop_again(step: BaseStep) -> None:
        if getattr(step, "kind", "") == "action":
            agent.stop()
            agent.release()
            agent.stop()

    agent.run("pick up the cube", stop_again)
    assert agent.opened.stop.pressed


def test_leaving_the_stream_stops_the_robot() -> None:
    """Whoever stops listening stops the robot, and the stop latches."""
    agent = cube()
    for step in agent.stream("pick up the cube"):
        if getattr(step, "kind", "") == "action":
            break
    assert agent.opened.stop.pressed


@pytest.mark.parametrize("said", ["clear the table", "throw all cubes away", "lift the cube, then clear the table"])
def test_nothing_is_cleared_where_there_is_no_bin(said: str) -> None:
    """The robot says so before anything moves, instead of finding out with the thing in its hand."""
    result = told(cube(), said)[0]
    assert (result.executed, result.success) == (False, False)
    assert "no bin" in result.answer
