"""From the goals that a model names to typed goals, by the grammar that also reads people: one meaning for one wording."""

from __future__ import annotations

from itertools import groupby

from agent.brain import UnusableReplyError
from agent.brains.replies import GoalReply, UnderstandReply
from agent.goal import Goal, Understanding
from agent.language.read_command import understand

WORDINGS = {
    "pick": "pick up {thing}", "hand_over": "hand me {thing}", "place": "put {thing} {place}", "clear": "clear the table",
    "sort": "sort by {measure}", "see": "what do you see", "where": "where is {thing}", "near": "what is near {thing}",
    "properties": "describe {thing}", "count": "how many {thing} are there", "held": "what are you holding",
    "why": "why did you grasp it that way", "why_failed": "why did it fail",
    "what_if": "what would have happened with {force} N", "help": "help", "stop": "stop",
}  # fmt: skip
"""Action -> the instruction that means it."""
EXPECTED = {
    "pick": ("pick", None), "hand_over": ("pick", None), "place": ("place", None), "clear": ("clear", None),
    "sort": ("sort", None), "see": ("look", "see"), "where": ("look", "where"), "near": ("look", "near"),
    "properties": ("look", "properties"), "count": ("look", "count"), "held": ("answer", "held"), "why": ("answer", "why"),
    "why_failed": ("answer", "why_failed"), "what_if": ("answer", "what_if"), "help": ("answer", "help"),
    "stop": ("answer", "stop"),
}  # fmt: skip
"""Action -> kind and query of the goal that must come of it."""


def understanding_of(reply: UnderstandReply) -> Understanding:
    """The typed goals of a reply. Said twice in a row, a goal is one: small models stutter, and nothing is picked up twice.

    Raises:
        UnusableReplyError: a goal says nothing that the grammar can read, or says two things at once.
    """
    if reply.goals:
        return Understanding(goals=tuple(goal for goal, _ in groupby(_goal(said, reply) for said in reply.goals)))
    if reply.question:
        return Understanding(question=reply.question)
    if reply.refusal:
        return Understanding(refusal=reply.refusal)
    raise UnusableReplyError(reply.model_dump_json(), "there is neither a goal nor a refusal nor a question")


def _goal(said: GoalReply, reply: UnderstandReply) -> Goal:
    template = WORDINGS[said.action]
    for name, value in (("thing", said.thing), ("place", said.place)):
        if f"{{{name}}}" in template and not value.strip():
            raise UnusableReplyError(reply.model_dump_json(), f"the action {said.action} needs a {name}")
    if said.action == "sort" and said.measure == "none":
        raise UnusableReplyError(reply.model_dump_json(), "the action sort needs a measure")
    if said.action == "what_if" and said.force_n == 0:
        raise UnusableReplyError(reply.model_dump_json(), "the action what_if needs a force")
    if said.action == "clear" and "except" in said.thing:
        template = "put {thing} in the bin"
    if said.action == "sort" and "descending" in f"{said.thing} {said.place}":
        template += " descending"
    words = template.format(thing=said.thing, place=said.place, measure=said.measure, force=said.force_n)
    got = understand(words)
    fits = len(got.goals) == 1 and (got.goals[0].kind, got.goals[0].query) == EXPECTED[said.action]
    if not fits:
        why = got.refusal or got.question or "it says more than one thing"
        raise UnusableReplyError(
            reply.model_dump_json(), f"{words!r} cannot be read as the action {said.action}: {why}"
        )
    return got.goals[0]
