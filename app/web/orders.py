"""What a page may ask for: every message is checked against these before anything happens. Sizes are bounded."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError

from app.web.portage import MAX_FILE
from kb.base import Finite, Noun
from kb.errors import BadInputError
from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE

Words = Annotated[str, Field(min_length=1, max_length=10_000)]
Name = Annotated[str, Field(min_length=1, max_length=200)]
ThreadName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$")]
Force = Annotated[float, Field(ge=MIN_FORCE, le=MAX_FORCE)]


class Enter(Noun):
    """The first message of a page."""

    type: Literal["enter"]
    page: Annotated[str, Field(pattern=r"^[A-Za-z0-9-]{8,64}$")]


class Say(Noun):
    """Words of the person; while the robot works they steer it."""

    type: Literal["say"]
    text: Words


class Plain(Noun):
    """Orders without a value."""

    type: Literal[
        "stop", "release", "approve", "reject", "why", "compare", "undo", "remember", "recall", "report", "resume",
        "take", "live", "fresh", "offers",
    ]  # fmt: skip


class Edit(Noun):
    """The pending motion with other numbers; limits are the hand's, for a placing (x, y) the table's."""

    type: Literal["edit"]
    force: Force | None = None
    aperture: Annotated[float, Field(ge=0.0, le=MAX_APERTURE)] | None = None
    yaw: Annotated[Finite, Field(ge=-6.3, le=6.3)] | None = None
    standoff: Annotated[float, Field(ge=0.02, le=0.20)] | None = None
    speed: Annotated[float, Field(ge=0.1, le=1.0)] | None = None
    x: Annotated[float, Field(ge=0.30, le=0.75)] | None = None
    y: Annotated[float, Field(ge=-0.35, le=0.35)] | None = None


class Asks(Noun):
    """Ask before every motion, or do not."""

    type: Literal["asks"]
    on: bool


class Speed(Noun):
    """How fast simulated time runs."""

    type: Literal["speed"]
    value: Literal[0, 1, 2, 4]


class Scene(Noun):
    """Another scene."""

    type: Literal["scene"]
    name: Name
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0


class Add(Noun):
    """One more object of the catalogue on the table."""

    type: Literal["add"]
    model: Name
    position: tuple[Finite, Finite] | None = None


class WhatIf(Noun):
    """Simulate the last attempt otherwise."""

    type: Literal["whatif"]
    force: Force | None = None
    aperture: Annotated[float, Field(ge=0.0, le=MAX_APERTURE)] | None = None
    yaw: Annotated[Finite, Field(ge=-6.3, le=6.3)] | None = None
    approach: Literal["top", "tilted", "side"] | None = None
    candidate: Literal["other"] | None = None


class Session(Noun):
    """Open, delete or pack a session."""

    type: Literal["session"]
    action: Literal["open", "delete", "export"]
    thread: ThreadName


class Upload(Noun):
    """A packed session follows in binary messages."""

    type: Literal["upload"]
    size: Annotated[int, Field(ge=1, le=MAX_FILE)]


class Fork(Noun):
    """Back to an earlier point of the conversation."""

    type: Literal["fork"]
    point: Name


class Replay(Noun):
    """Show a moment of a recorded run."""

    type: Literal["replay"]
    run: Annotated[int, Field(ge=0, lt=1_000_000)]
    share: Annotated[float, Field(ge=0.0, le=1.0)]


class Point(Noun):
    """Set off a candidate in the 3D view."""

    type: Literal["point"]
    name: Name | None = None


Order = Annotated[
    Say | Plain | Edit | Asks | Speed | Scene | Add | WhatIf | Session | Upload | Fork | Replay | Point,
    Field(discriminator="type"),
]
_ORDER: TypeAdapter[Any] = TypeAdapter(Order)


def parse_enter(raw: str | bytes) -> Enter:
    """The first message of a page.

    Raises:
        BadInputError: it is something else.
    """
    try:
        return Enter.model_validate_json(raw)
    except ValidationError as error:
        raise BadInputError("a page says first who it is", where="page") from error


def parse_order(raw: str | bytes) -> Any:
    """The order of a page.

    Raises:
        BadInputError: it is none.
    """
    try:
        return _ORDER.validate_json(raw)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        raise BadInputError(str(first["msg"]), where=".".join(str(part) for part in first["loc"]) or "page") from error
