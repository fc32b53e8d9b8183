"""The paper's own kind of evaluation (Sec. IV-D, V-A): the outcome of a grasp from the seven factors on the true scene.

No physics engine, no dice: y = 1 iff the pose is reachable, every factor reaches its threshold, Q is at least 0.60, and no
constraint is violated (ledger G15 to G17). Always to be shown beside the physical evaluator, never mixed with it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, cast

import mujoco
import numpy as np
from pydantic import Field

from kb.base import Finite, Noun
from kb.by_identity import ByIdentity
from kb.grasp import Grasp, Quality
from kb.vocabulary import FailureType
from sim.footprint import geom_points
from sim.hand import hand_boxes
from sim.local_width import local_width, near_pads, region_distance
from sim.placed import Geom, PlacedObject
from sim.pose import Array, point_in_body, rotation_of
from sim.quality import REACH_ERROR, Circumstances, Subject, failure_of, grade
from sim.reach import Unreachable
from sim.swept_hand import ROUNDING, swept_distances, swept_leasts
from sim.world import World

TABLE_ALLOWANCE = 0.001
"""The hand may come this close to the table [m]; nearer is a collision, farther does not count (ledger G15)."""
SLOW = 0.3
"""Velocity scale that keeps contents in their container (ledger G11)."""
CONTENT_TILT = math.radians(15.0)
"""Tilt of the approach that keeps contents in their container [rad] (ledger G11)."""
ON_TOP = 0.02
"""A thing whose base is within this of another's top stands on it [m]."""


class Outcome(Noun):
    """What the analytic evaluator says about one motion. The robot is not told; the observer keeps it."""

    attempt: int
    gripped: str | None
    """The object between the fingers, or None."""
    failure: FailureType | None
    quality: Quality | None = None
    width: Finite = 0.0
    """Local width between the fingers [m]."""
    force: Finite = 0.0
    """[N]."""
    height: Finite = 0.0
    """How far it was lifted [m]."""
    clearance: dict[str, float] = Field(default_factory=dict)
    """Other object -> smallest distance of the swept hand [m]."""
    tilt: Finite = 0.0
    """Approach off vertical [rad]."""
    speed: Finite = 1.0
    supports: tuple[str, ...] = ()
    """What stood on the gripped object."""
    placed: str | None = None
    """For a placing motion: what was put down."""


def evaluate(world: World, grasp: Grasp, reach: Any, attempt: int) -> Outcome:
    """Outcome of a grasp in the world as it stands.

    Args:
        world: Its poses are read, nothing is changed.
        grasp: The grasp.
        reach: What `sim.reach.solve_reach` said.
        attempt: Number of the motion.
    """
    tilt = math.acos(max(-1.0, min(1.0, -grasp.approach[2] / float(np.linalg.norm(grasp.approach)))))
    base = {"attempt": attempt, "force": grasp.force, "tilt": tilt, "speed": grasp.speed}
    if isinstance(reach, Unreachable):
        return Outcome(gripped=None, failure="UNREACHABLE_POSE", **base)
    movable = [thing for thing in world.placed.objects if not thing.fixed]
    mujoco.mj_kinematics(world.model, world.data)
    widths, clearances = _geometry(world, movable, grasp)
    between = [thing for thing in movable if widths[thing.id] > 0.0]
    thing = min(between or movable, key=lambda item: _error(world, item, grasp), default=None)
    if thing is None:
        return Outcome(gripped=None, failure="POSITION_ERROR", **base)
    clearance = clearances(thing)
    supports = tuple(other.id for other in movable if other.id != thing.id and _stands_on(world, other, thing))
    near = min((value for name, value in clearance.items() if name not in supports), default=math.inf)
    table = _above_table(grasp) >= TABLE_ALLOWANCE
    error = _error(world, thing, grasp)
    subject = Subject(
        region_distance=error if between else max(error, REACH_ERROR),
        width=widths[thing.id],
        mass=thing.mass,
        friction=thing.friction,
        fragility=thing.affordance.fragility,
        affordance=thing.affordance.type,
        clearance=min(near, 1.0) if table else 0.0,
    )
    facts = Circumstances(
        blocked_by="object" if table else "table",
        material=thing.affordance.material,
        constraint_violated=_violated(world, thing, grasp, tilt, supports),
    )
    quality = grade(grasp, subject)
    return Outcome(
        gripped=thing.id if between else None,
        failure=failure_of(quality, grasp, subject, facts),
        quality=quality,
        width=widths[thing.id],
        height=float(reach.height),
        clearance=clearance,
        supports=supports,
        **base,
    )


def _geometry(
    world: World, movable: list[PlacedObject], grasp: Grasp
) -> tuple[dict[str, float], Callable[[PlacedObject], dict[str, float]]]:
    """Widths between the pads, and the clearances from all but one thing, each reckoned once for things that lie so.

    Configurations of a trial, and corrections of force or speed, close the hand at the very same place again.
    """
    qpos = world.data.qpos
    lie = b"".join(
        qpos[address].tobytes() for thing in movable if (address := world.index.objects[thing.id].qpos) is not None
    )
    way = grasp.position, grasp.approach, grasp.yaw, grasp.aperture, grasp.standoff, lie
    kept = _met.get((world.placed,), None, dict[Hashable, Any])
    if way not in kept:
        kept[way] = _widths(world, movable, grasp)

    def clearances(thing: PlacedObject) -> dict[str, float]:
        if (way, thing.id) not in kept:
            kept[way, thing.id] = _clearances(world, [other for other in movable if other.id != thing.id], grasp)
        return dict(kept[way, thing.id])

    return kept[way], clearances


_met: ByIdentity[dict[Hashable, Any]] = ByIdentity(2)
"""For the latest scenes: where a hand closed, and how things lay -> what was between the pads and beside its way."""


def cloud(world: World, thing: PlacedObject) -> Array:
    """Points on and in an object where it is now [m], (N, 3), at most about 2 cm apart on its pieces."""
    position, rotation = _pose(world, thing)
    return np.vstack(_pieces(thing.geoms).points) @ rotation.T + position


def _pose(world: World, thing: PlacedObject) -> tuple[Array, Array]:
    """Position (3,) [m] and rotation (3, 3) of an object now."""
    address = world.index.objects[thing.id].qpos
    pose = np.array([*thing.position, *thing.quaternion]) if address is None else world.data.qpos[address]
    return pose[:3], rotation_of(pose[3:])


def _clearances(world: World, things: list[PlacedObject], grasp: Grasp) -> dict[str, float]:
    """Smallest distance of the swept hand from each object's `cloud` [m].

    No point of a piece is nearer than the middle of its sphere by more than the sphere's radius: each object's nearest
    piece by that measure is measured first, and then only what may be nearer still.
    """
    if not things:
        return {}
    poses = [_pose(world, thing) for thing in things]
    spheres = [_pieces(thing.geoms) for thing in things]
    middles = [
        pieces.middles @ rotation.T + position for pieces, (position, rotation) in zip(spheres, poses, strict=True)
    ]
    away = np.split(
        swept_distances(grasp, np.vstack(middles)), np.cumsum([len(pieces.points) for pieces in spheres])[:-1]
    )
    bounds = [far - pieces.radii for far, pieces in zip(away, spheres, strict=True)]

    def measured(chosen: list[tuple[int, int]]) -> list[float]:
        """Distances of pieces, given as numbers of thing and piece."""
        placed = [spheres[thing].points[piece] @ poses[thing][1].T + poses[thing][0] for thing, piece in chosen]
        return swept_leasts(grasp, placed) if placed else []

    nearest = [int(np.argmin(least)) for least in bounds]
    found = measured(list(enumerate(nearest)))
    rest = [
        (thing, piece)
        for thing, (first, least) in enumerate(zip(nearest, bounds, strict=True))
        for piece in np.flatnonzero(least < found[thing] + ROUNDING).tolist()
        if piece != first
    ]
    for (thing, _), distance in zip(rest, measured(rest), strict=True):
        found[thing] = min(found[thing], distance)
    return {thing.id: distance for thing, distance in zip(things, found, strict=True)}


@dataclass(frozen=True)
class _Pieces:
    """Points on and in the pieces of an object, and a sphere around each, in the object's frame [m]."""

    points: tuple[Array, ...]
    middles: Array
    radii: Array

    @classmethod
    def of(cls, geoms: tuple[Geom, ...]) -> _Pieces:
        """The pieces that an object is made of."""
        points = tuple(_filled(geom_points(geom)) for geom in geoms)
        middles = np.array([(cloud.min(axis=0) + cloud.max(axis=0)) / 2 for cloud in points])
        radii = [np.linalg.norm(cloud - middle, axis=1).max() for cloud, middle in zip(points, middles, strict=True)]
        return cls(points, middles, np.array(radii))


def _pieces(geoms: tuple[Geom, ...]) -> _Pieces:
    """The pieces of an object; the same ones are asked for at every grasp of a trial."""
    known = _known.get(id(geoms))
    if known is None or known[0] is not geoms:
        known = geoms, _Pieces.of(geoms)
        while len(_known) >= KEPT:
            _known.pop(next(iter(_known)), None)
        _known[id(geoms)] = known
    return known[1]


KEPT = 32
"""Objects whose points are kept: more than a scene has."""
_known: dict[int, tuple[tuple[Geom, ...], _Pieces]] = {}
"""Identity of an object's pieces -> the pieces themselves, which keep their identity their own, and their points."""


def _filled(corners: Array) -> Array:
    """The corners of a convex piece and points on the lines between them."""
    if len(corners) > 40:
        corners = corners[np.linspace(0, len(corners) - 1, 40).astype(int)]
    first, second = np.triu_indices(len(corners), 1)
    shares = np.array([0.2, 0.4, 0.6, 0.8])[:, None, None]
    between = (1 - shares) * corners[first] + shares * corners[second]
    return np.vstack([corners, between.reshape(-1, 3)])


def _widths(world: World, things: list[PlacedObject], grasp: Grasp) -> dict[str, float]:
    """Width of each object between the pads [m]; only what comes near them is cut with lines."""
    geoms = [world.index.objects[thing.id].geoms for thing in things]
    flat = [geom for some in geoms for geom in some]
    if not flat:
        return {thing.id: 0.0 for thing in things}
    near = iter(near_pads(world.model, cast(Any, world.data), flat, np.asarray(grasp.position), grasp.aperture))
    met = [any([next(near) for _ in some]) for some in geoms]
    return {thing.id: _width(world, thing, grasp) if keep else 0.0 for thing, keep in zip(things, met, strict=True)}


def _width(world: World, thing: PlacedObject, grasp: Grasp) -> float:
    """Width between the pads [m]; the positions of the geoms must be up to date."""
    geoms, data = world.index.objects[thing.id].geoms, cast(Any, world.data)
    return local_width(world.model, data, geoms, grasp.position, grasp.rotation(), grasp.aperture)


def _error(world: World, thing: PlacedObject, grasp: Grasp) -> float:
    """e_p: distance of the grasp's position from the object's affordance region [m]."""
    address = world.index.objects[thing.id].qpos
    return region_distance(thing, point_in_body(world.data.qpos[address], grasp.position))


def _above_table(grasp: Grasp) -> float:
    """Height of the hand's lowest corner at the grasp [m]."""
    from sim.hand import TCP_OFFSET

    rotation, lowest = grasp.rotation(), math.inf
    for centre, half in hand_boxes(grasp.aperture):
        middle = np.asarray(grasp.position) + rotation @ (centre - [0.0, 0.0, TCP_OFFSET])
        lowest = min(lowest, float(middle[2] - np.abs(rotation[2]) @ half))
    return lowest


def _stands_on(world: World, upper: PlacedObject, lower: PlacedObject) -> bool:
    """Whether one object's base is at or inside another's outline, above its base."""
    a, b = (world.data.qpos[world.index.objects[thing.id].qpos][:3] for thing in (upper, lower))
    aside = float(np.linalg.norm(a[:2] - b[:2]))
    return aside < max(lower.size[:2]) / 2 and 0.005 < a[2] - b[2] < lower.size[2] + ON_TOP


def _violated(world: World, thing: PlacedObject, grasp: Grasp, tilt: float, supports: tuple[str, ...]) -> bool:
    """Whether a constraint that the task requires for this object is broken by how it is taken."""
    task = world.placed.task
    if task is None:
        return False
    for required in task.required:
        if required.kind == "support" and required.target in supports:
            return True
        if (
            required.kind == "content"
            and required.target == thing.id
            and (tilt > CONTENT_TILT or grasp.speed > SLOW + 1e-9)
        ):
            return True
    return task.side_grasp_of == thing.id and not math.radians(30) <= tilt <= math.radians(60)
