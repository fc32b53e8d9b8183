"""What a scene file says, before anything is drawn (product.md, "Scene files"). SI units, angles in radians."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from kb.base import Finite, Noun
from kb.vocabulary import ConstraintKind

Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_\-]{0,63}$")]
"""An object's id: letters, digits, - and _, not starting with a digit."""
Positive = Annotated[Finite, Field(gt=0.0)]
Share = Annotated[Finite, Field(ge=0.0, le=1.0)]
Coordinate = Annotated[Finite, Field(ge=-10.0, le=10.0)]
Range = tuple[Finite, Finite]
"""A lower and an upper bound of a uniform draw."""
RESERVED_IDS = ("table", "floor", "robot", "world", "particle")


NAME_OF_SCENE = r"^[A-Za-z0-9_][A-Za-z0-9_\-. ]{0,63}$"


class ObjectSpec(Noun):
    """One object of a scene. What is left out is drawn or comes from the catalogue."""

    id: Name
    model: str | None = None
    """Catalogue name; or one of `mesh` and `mjcf` for the user's own object."""
    mesh: str | None = None
    """Path of a mesh file, relative to the scene file."""
    mjcf: str | None = None
    """Path of an MJCF file with one free body, relative to the scene file."""
    position: Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=3)] | None = None
    """Centre of the footprint [m], and optionally the height of the lowest point above the table. Left out and without
    `near` or `on`: drawn in the spawn area."""
    yaw: Annotated[Finite, Field(ge=-100.0, le=100.0)] = 0.0
    near: Name | None = None
    """Id of the object it stands beside."""
    gap: Positive | Range | None = None
    """Free distance to it [m], or a range to draw from; default U(0.04, 0.08)."""
    bearing: Finite | Range | None = None
    """Direction from it, 0 along x, counter-clockwise; or a range; default any."""
    on: Name | None = None
    """Id of the object it lies on or in."""
    state: Literal["empty", "filled"] = "empty"
    scale: Annotated[Finite, Field(gt=0.0, le=1000.0)] = 1.0
    mass: Annotated[Finite, Field(gt=0.0, le=50.0)] | None = None
    friction: Annotated[Finite, Field(gt=0.0, le=3.0)] | None = None
    up: Literal["y", "z"] = "z"
    """Axis of the mesh that points up."""
    color: tuple[Share, Share, Share] | None = None
    category: str | None = Field(default=None, min_length=1, max_length=64)
    fragility: Share | None = None

    @model_validator(mode="after")
    def _one_source_one_place(self) -> ObjectSpec:
        if sum(value is not None for value in (self.model, self.mesh, self.mjcf)) != 1:
            raise ValueError("it needs exactly one of model, mesh and mjcf")
        if sum(value is not None for value in (self.position, self.near, self.on)) > 1:
            raise ValueError("it takes only one of position, near and on")
        if self.near is None and (self.gap is not None or self.bearing is not None):
            raise ValueError("gap and bearing need near")
        if isinstance(self.gap, tuple) and not 0.0 < self.gap[0] <= self.gap[1]:
            raise ValueError("the gap's range must be positive and ascending")
        if isinstance(self.bearing, tuple) and self.bearing[0] > self.bearing[1]:
            raise ValueError("the bearing's range must be ascending")
        if self.id in RESERVED_IDS:
            raise ValueError(f"the id {self.id!r} is reserved")
        if self.position is not None and len(self.position) == 3 and not 0.0 <= self.position[2] <= 0.5:
            raise ValueError("the third number of position is the height above the table, 0 to 0.5 m")
        return self


class Randomise(Noun):
    """Half-widths of the uniform draws that are added to what the file says."""

    position: Annotated[Finite, Field(ge=0.0, le=0.3)] = 0.0
    """Along x and y [m]."""
    yaw: Annotated[Finite, Field(ge=0.0, le=3.1416)] = 0.0
    size: Annotated[Finite, Field(ge=0.0, lt=0.5)] = 0.0
    """Relative."""
    mass: Annotated[Finite, Field(ge=0.0, lt=1.0)] = 0.0
    """Relative."""
    friction: Annotated[Finite, Field(ge=0.0, lt=1.0)] = 0.0
    """Relative."""


class RequiredSpec(Noun):
    """A constraint that the task requires of the robot."""

    kind: ConstraintKind
    target: Name


class TaskSpec(Noun):
    """The task that goes with a scene."""

    target: Name | None = None
    instructions: tuple[Annotated[str, Field(min_length=1, max_length=10_000)], ...] = Field(min_length=1)
    required: tuple[RequiredSpec, ...] = ()
    side_grasp_of: Name | None = None
    kind: Literal["pick", "clear", "sort"] = "pick"


class Source(Noun):
    """Where a scene was read from; never part of the file."""

    file: str | None = None
    """Path of the user's file; None for a built-in scene."""
    lines: dict[str, int] = Field(default_factory=dict)
    """Object id -> line of its entry, from 1."""


class SceneSpec(Noun):
    """A scene as a file describes it."""

    name: Annotated[str, Field(pattern=NAME_OF_SCENE)]
    objects: tuple[ObjectSpec, ...] = Field(min_length=1, max_length=40)
    randomise: Randomise = Field(default_factory=Randomise)
    like: Annotated[str, Field(pattern=NAME_OF_SCENE)] | None = None
    """Scene whose instances (sizes, colours, masses, light) the same seed draws here, too; a changed copy has its original's."""
    separation: Annotated[Finite, Field(ge=0.0, le=0.3)] = 0.02
    """Smallest free distance between objects whose places are drawn and that have no `near` or `on` relation [m]."""
    task: TaskSpec | None = None
    source: Source = Field(default_factory=Source)

    @property
    def builtin(self) -> bool:
        """Whether it is one of the product's own scenes."""
        return self.source.file is None

    def entry(self, object_id: str) -> ObjectSpec:
        """The entry of that id; KeyError if there is none."""
        for thing in self.objects:
            if thing.id == object_id:
                return thing
        raise KeyError(object_id)

    def where(self, object_id: str | None = None) -> str:
        """Place of an object's entry for an error message: "file:line: object 'id'"."""
        place = self.source.file or self.name
        if object_id is None:
            return place
        line = self.source.lines.get(object_id)
        return f"{place}{'' if line is None else f':{line}'}: object {object_id!r}"
