"""What a model must reply, as strict models; their JSON schemas constrain decoding where a server or a grammar can.

Every text and list is bounded, and every number is an integer with bounds, so that constrained decoding always ends
with a valid reply. The bounds here are those of the hand; the gate knows those of the moment.
"""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from agent.brain import UnusableReplyError
from kb.taxonomy import CATEGORIES
from kb.vocabulary import UNKNOWN_CATEGORY, AffordanceType, Material, ObjectState, Region, Relation

Action = Literal[
    "pick", "hand_over", "place", "clear", "sort", "see", "where", "near", "properties", "count", "held", "why",
    "why_failed", "what_if", "help", "stop",
]  # fmt: skip
MAX_GOALS, MAX_OBJECTS, MAX_RELATIONS = 4, 12, 12
PRINTABLE = r"^[ !#-\[\]-~]"
ReplyT = TypeVar("ReplyT", bound=BaseModel)


def _text(longest: int) -> Any:
    """A text of at most so many characters.

    The schema's pattern has printable ASCII without quotation mark and backslash, so that a grammar can neither escape
    nor run on; a reply that was not constrained by it may hold any characters.
    """
    return Field(max_length=longest, json_schema_extra={"pattern": PRINTABLE + f"{{0,{longest}}}$"})


class Strict(BaseModel):
    """No other keys, nothing optional."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class GoalReply(Strict):
    action: Action
    thing: Annotated[str, _text(60)]
    place: Annotated[str, _text(40)]
    measure: Literal["none", "fragility", "size", "weight"]
    force_n: Annotated[int, Field(ge=0, le=70)]


class UnderstandReply(Strict):
    goals: Annotated[list[GoalReply], Field(max_length=MAX_GOALS)]
    refusal: Annotated[str, _text(120)]
    question: Annotated[str, _text(120)]


class ObjectReply(Strict):
    mark: Annotated[int, Field(ge=0, le=99)]
    category: Literal[(*CATEGORIES, UNKNOWN_CATEGORY)]  # pyright: ignore[reportInvalidTypeForm]
    affordance: AffordanceType
    material: Material
    fragility: Annotated[int, Field(ge=0, le=10)]
    region: Region
    state: ObjectState


class RelationReply(Strict):
    source: Annotated[int, Field(ge=0, le=99)]
    relation: Relation
    target: Annotated[int, Field(ge=0, le=99)]


class PerceiveReply(Strict):
    objects: Annotated[list[ObjectReply], Field(max_length=MAX_OBJECTS)]
    relations: Annotated[list[RelationReply], Field(max_length=MAX_RELATIONS)]


class ThinkReply(Strict):
    thought: Annotated[str, _text(240)]
    choice: Literal["act", "look_again", "ask", "give_up"]
    candidate: Annotated[int, Field(ge=0, le=9)]
    force_n: Annotated[int, Field(ge=0, le=70)]
    opening_mm: Annotated[int, Field(ge=0, le=80)]
    speed_percent: Annotated[int, Field(ge=0, le=100)]
    question: Annotated[str, _text(120)]


class ReflectReply(Strict):
    thought: Annotated[str, _text(240)]
    choice: Annotated[int, Field(ge=0, le=9)]
    give_up: bool


class AnswerReply(Strict):
    text: Annotated[str, _text(500)]


MAX_TOKENS: dict[type[BaseModel], int] = {
    UnderstandReply: 1300, PerceiveReply: 3500, ThinkReply: 640, ReflectReply: 320, AnswerReply: 560,
}  # fmt: skip
"""Longest reply [tokens]: enough for every reply within the bounds above even at one character a token."""


def schema_of(kind: type[BaseModel]) -> dict[str, Any]:
    """JSON schema of a reply, without titles, which only cost tokens."""
    return _bare(kind.model_json_schema())


def _bare(value: Any, names: bool = False) -> Any:
    """Without titles and descriptions of schemas; properties that have these names stay."""
    if isinstance(value, dict):
        return {
            key: _bare(item, names=key in ("properties", "$defs"))
            for key, item in value.items()
            if names or (key not in ("title", "description") and not (key == "maxLength" and "pattern" in value))
        }
    return [_bare(item) for item in value] if isinstance(value, list) else value


def parse(text: str, kind: type[ReplyT]) -> ReplyT:
    """The reply as a value.

    Raises:
        UnusableReplyError: it is empty, not JSON, or not of the schema.
    """
    if not text.strip():
        raise UnusableReplyError(text, "the reply is empty")
    try:
        return kind.model_validate(json.loads(_body(text), parse_constant=_no_constant))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise UnusableReplyError(text, f"the reply does not fit the schema: {where}: {first['msg']}") from None
    except (ValueError, RecursionError) as error:
        raise UnusableReplyError(text, f"the reply is not JSON: {' '.join(str(error).split())[:120]}") from None


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no number")


def _body(text: str) -> str:
    """The text without the code fence that many models put around JSON."""
    inner = text.strip()
    if inner.startswith("```") and inner.endswith("```") and "\n" in inner:
        return inner[inner.index("\n") + 1 : -3]
    return inner
