"""What a person asked for, as typed values: references to things, places to put them, and goals."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kb.base import Noun, Vec3
from kb.vocabulary import GoalKind

Side = Literal["left", "right", "front", "back", "middle"]
Extreme = Literal[
    "biggest", "smallest", "tallest", "shortest", "widest", "thinnest", "heaviest", "lightest", "most_fragile",
    "least_fragile", "leftmost", "rightmost", "nearest", "farthest", "middle",
]  # fmt: skip
"""A superlative that singles one thing out; places are seen by the person at the front camera (kb.viewpoint)."""

RelationWord = Literal[
    "near", "left_of", "right_of", "behind", "in_front_of", "on", "under", "between", "in", "touching", "nearest_to"
]
"""A spatial relation as a person says it."""

Query = Literal["see", "where", "near", "why", "why_failed", "what_if", "help", "stop", "held", "properties", "count"]
"""A question that a look or an answer goal is about."""

Measure = Literal["fragility", "size", "weight"]
"""What a sort goes by."""


class RelationTo(Noun):
    """`<the thing> relation <others>`."""

    relation: RelationWord
    others: tuple[Reference, ...] = ()


class Reference(Noun):
    """How a person refers to a thing. Everything that is not said stays None."""

    words: str = ""
    """The phrase as it was said, cleaned."""
    noun: str | None = None
    """Head noun as said, singular."""
    categories: tuple[str, ...] = ()
    """Categories that the noun may denote; empty for "thing", "object", "one" and for nouns we don't know."""
    known: bool = True
    """False: a noun outside our vocabulary ("teapot")."""
    colour: str | None = None
    material: str | None = None
    shape: str | None = None
    """"round", "flat": an adjective of `agent.language.lexicon.SHAPES`."""
    state: Literal["filled", "empty"] | None = None
    quality: Literal["big", "small", "tall", "short", "fragile", "heavy", "light"] | None = None
    """A gradable adjective that is not a superlative: settles between two candidates, never excludes a single one."""
    extreme: Extreme | None = None
    ordinal: int | None = None
    """1 = first, -1 = last, counted from `ordinal_from`."""
    ordinal_from: Literal["left", "right", "front", "back"] = "left"
    relation: RelationTo | None = None
    side: Side | None = None
    """"the cup on the left"."""
    other: bool = False
    """"the other cup": not the one that was dealt with last."""
    pronoun: bool = False
    """"it", "that", "this one": what was dealt with last."""
    plural: bool = False
    """"all cups", "the apples", "everything"."""
    anyone: bool = False
    """"a cup", "any cup": whichever of those that fit."""
    count: int | None = None
    """"two cups"."""
    excluding: tuple[Reference, ...] = ()
    """"everything except the glass", "not the red one"."""
    ids: tuple[str, ...] = ()
    """Perceived ids, where the agent itself (not a person) refers to a thing, or "obj_3" was said."""


class Placement(Noun):
    """Where a thing is to go."""

    kind: Literal["bin", "side", "beside", "on", "back", "aside", "lane", "hand_over"]
    """"back": where it was taken from; "aside": any free place; "lane": for sorting, left to right."""
    side: Side | None = None
    relation: RelationWord | None = None
    """For "beside": on which side of the reference."""
    reference: Reference | None = None
    target: str | None = None
    """Perceived id of the reference, once grounded."""
    point: tuple[float, float] | None = None
    """For "back": where the thing was [m], if it is not in the hand any more; else: where a person wants it."""
    or_aside: bool = False
    """Where there is no bin, out of the way will do ("remove the block")."""
    from_hand: bool = False
    """Only what is in the hand is put down ("drop it", "let go"): nothing is taken up for it."""
    lane: tuple[int, int] | None = None
    """(number from the robot's left, number of lanes)."""


class Goal(Noun):
    """One thing to achieve, and how far it has come. Goals are replaced, never changed."""

    kind: GoalKind
    reference: Reference | None = None
    placement: Placement | None = None
    query: Query | None = None
    measure: Measure | None = None
    descending: bool = False
    """Sort from much to little."""
    force: Annotated[float, Field(gt=0)] | None = None
    """Force of a what-if question [N]."""
    parent: int | None = None
    """Index of the goal this one serves."""
    target: str | None = None
    """Perceived id of the object meant, once grounded."""
    target_category: str | None = None
    """What a person would call the target: the noun's category where one was said, else what was perceived."""
    target_position: Vec3 | None = None
    """Where the target was when it was grounded, or before it was taken if it is in the hand [m]."""
    taken_in: int | None = None
    """Number of the motion that took the target, if it was in the hand already when this goal began."""
    status: Literal["open", "done", "failed"] = "open"
    claimed: bool = False
    """The agent's own word."""
    note: str = ""
    """Why it failed, or what should be said about it (an unknown object taken at the person's word)."""

    @property
    def moves(self) -> bool:
        """Whether this goal needs the robot to move."""
        return self.kind in ("pick", "place", "clear", "sort")


class Understanding(Noun):
    """What an instruction was taken to mean."""

    goals: tuple[Goal, ...] = ()
    refusal: str | None = None
    """Why nothing will be done: not understood, contradictory, or beyond what the robot can do."""
    question: str | None = None
    """What to ask the person back."""
    pending: Goal | None = None
    """What was understood of the command that the question completes."""


RelationTo.model_rebuild()
