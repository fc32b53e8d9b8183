"""Where a held object can be set down: free places, the hand's pose there, and whether the arm gets to it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal

import numpy as np

from kb.base import Vec2, Vec3
from kb.grasp import Grasp
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan
from sim.carry_path import GENTLE, STAGES, way_down
from sim.hand import TCP_OFFSET
from sim.kinematics import forward
from sim.motion import CARRIED_RADIUS, Obstacle
from sim.place_motion import RETREAT, way_back
from tools.planning.arm_clearance import path_clearance
from tools.planning.candidate import Array, vec3
from tools.planning.hand_out import meets
from tools.planning.outline import clear_case, outline, rectangle_gap
from tools.planning.surroundings import completed

TABLE_X, TABLE_Y = (0.31, 0.74), (-0.34, 0.34)
"""Where footprints' centres may stand: the table (ledger G40) less a margin [m]."""
GAP = 0.03
"""Distance kept between what is set down and what stands there [m]."""
TURNS = tuple(math.radians(a) for a in (0, 20, -20, 45, -45, 70, -70, 95, -95, 130, -130, 180))
"""Turns of the held object about the vertical that are tried [rad]."""
DROP = 0.004
"""Height above the support at which the set-down aims [m]; contact is felt for from there."""
STRIP_STEP = 0.03
"""Distance of the rows of places in a lane [m]."""
UPRIGHT_HAND = 0.9
"""Cosine of the hand's tilt from which its way back is its way up."""
SPHERE_STEP = 0.04
"""Distance of the spheres that stand for what is held [m]."""
ARM_GAP = 0.012
"""Distance that the arm's links keep from everything on the way down [m]."""


@dataclass(frozen=True)
class SetDown:
    """A hand pose at which the object stands (or hangs just above) the wanted place."""

    position: Vec3
    """Tool point [m]."""
    approach: Vec3
    yaw: float
    centre: Vec2
    """Where the footprint's centre will be [m]."""
    turn: float = 0.0
    """How far the object is turned about the vertical against how it stood [rad]."""


def footprint_radius(held: PerceivedObject) -> float:
    """Radius of a circle around the footprint [m]."""
    return (
        0.5 * math.hypot(held.size[0], held.size[1]) if held.shape not in ("sphere", "cylinder") else held.size[0] / 2
    )


def is_free(
    centre: Vec2,
    radius: float,
    percept: Percept,
    ignore: tuple[str, ...] = (),
    gap: float = GAP,
    height: float = math.inf,
) -> bool:
    """Whether a circle on the table keeps its distance from every perceived object's box.

    What hangs higher than `height` [m] (an edge of the robot's own hand that was taken for a thing) leaves the place free.
    """
    if not (TABLE_X[0] <= centre[0] <= TABLE_X[1] and TABLE_Y[0] <= centre[1] <= TABLE_Y[1]):
        return False
    return all(
        box_distance(centre, other) >= radius + gap
        for other in percept.objects
        if other.id not in ignore and other.base_z < height
    )


def box_distance(point: Vec2, other: PerceivedObject) -> float:
    """Distance of a point from the footprint of an object's box [m]; 0 inside."""
    cosine, sine = math.cos(other.yaw), math.sin(other.yaw)
    x, y = point[0] - other.position[0], point[1] - other.position[1]
    along, across = abs(cosine * x + sine * y) - other.size[0] / 2, abs(cosine * y - sine * x) - other.size[1] / 2
    return math.hypot(max(along, 0.0), max(across, 0.0))


def spiral(centre: Vec2, step: float = 0.02, rings: int = 9) -> Iterator[Vec2]:
    """Points around a centre, nearest first."""
    yield centre
    for ring in range(1, rings + 1):
        count = 6 * ring
        for k in range(count):
            angle = 2 * math.pi * k / count
            yield centre[0] + ring * step * math.cos(angle), centre[1] + ring * step * math.sin(angle)


def strip(corners: tuple[Vec2, Vec2], inset: float) -> Iterator[Vec2]:
    """Places in an upright strip of the table (a lane), those near its middle line first.

    Args:
        corners: Its near right and far left corner [m].
        inset: Distance that the places keep from its left and right edges [m].
    """
    (x0, y0), (x1, y1) = corners
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    widest = max(0.0, (y1 - y0) / 2 - inset)
    rows = np.arange(0.0, (x1 - x0) / 2 + 1e-9, STRIP_STEP)
    steps = [
        (float(dx), float(dy))
        for dx in np.unique(np.concatenate([-rows, rows]))
        for dy in (0.0, -widest / 2, widest / 2, -widest, widest)
    ]
    for dx, dy in sorted(steps, key=lambda step: (round(abs(step[0]) + 2 * abs(step[1]), 6), step)):
        yield middle[0] + dx, middle[1] + dy


def stands_clear(held: PerceivedObject, option: SetDown, others: Iterable[PerceivedObject], gap: float) -> bool:
    """Whether the held object's box, turned as it will be, keeps a distance [m] from the boxes of others."""
    height = held.size[2] + GAP
    near: list[PerceivedObject] = []
    for other in others:
        if other.base_z < height:
            keeps = clear_case(option.centre, held.size, other.position, other.size, gap)
            if keeps is False:
                return False
            if keeps is None:
                near.append(other)
    if not near:
        return True
    mine = outline(option.centre, held.size, held.yaw + option.turn)
    return all(rectangle_gap(mine, _standing(other.position, other.size, other.yaw)) >= gap for other in near)


_standing = lru_cache(maxsize=64)(outline)
"""Outlines of what stands there, which every place is held against."""


def hand_at_grasp(held: Plan) -> Array:
    """Rotation of the hand when it closed (3, 3); the stored posture tells which way round it was."""
    rotation = held.grasp.rotation()
    if len(held.joints) == 7:
        actual = forward(np.asarray(held.joints))[:3, :3]
        if float(actual[:, 1] @ rotation[:, 1]) < 0.0:
            rotation = rotation @ np.diag([-1.0, -1.0, 1.0])
    return rotation


def set_downs(held: PerceivedObject, plan: Plan, centre: Vec2, support_z: float) -> Iterator[SetDown]:
    """Hand poses that put the object's footprint at `centre`, upright, turned by each of `TURNS`.

    Args:
        held: The object as it stood when it was gripped.
        plan: The plan that holds it.
        centre: Wanted centre of the footprint [m].
        support_z: Height of what it is to stand on [m].
    """
    x, y, z = plan.grasp.position
    offset = x - held.position[0], y - held.position[1], z - held.base_z
    rotation = hand_at_grasp(plan)
    across, along = rotation[:, 1].tolist(), rotation[:, 2].tolist()
    # A top grasp may turn freely; a side grasp turns with the bearing so that the arm stays in its plane.
    start = math.atan2(held.position[1], held.position[0])
    natural = math.atan2(centre[1], centre[0]) - start if abs(plan.grasp.approach[2]) < 0.8 else 0.0
    for turn in TURNS:
        angle = natural + turn
        closing, aside = _turned(across, angle), _turned(offset, angle)
        yield SetDown(
            position=(centre[0] + aside[0], centre[1] + aside[1], support_z + DROP + aside[2]),
            approach=_turned(along, angle),
            yaw=math.atan2(closing[1], closing[0]),
            centre=centre,
            turn=angle,
        )


Care = Literal["careful", "gentle", "any"]
"""How what is held is carried to a place and left there: upright and straight back, tipped by 25 degrees at most, or so
that it gets there at all."""


@dataclass(frozen=True)
class Scene:
    """What a set-down has to reckon with, as perceived."""

    plan: Plan
    """The plan that holds the object."""
    joints: Array
    """Joint angles now [rad], (7,)."""
    points_w: Array
    """Surface points of everything else (N, 3) [m]."""
    boxes: tuple[Obstacle, ...]
    """The same as boxes, for the free way."""
    load: Array
    """Points of what is held in the hand frame (P, 3) [m]."""
    has_arm: bool = True
    """Whether the links take up room; without, the hand's own clearance decides."""
    met: dict[tuple[object, ...], bool] = field(
        default_factory=dict[tuple[object, ...], bool], compare=False, repr=False
    )
    """Ways of the hand that were looked at -> whether it meets something there."""


def feasible(option: SetDown, scene: Scene, care: Care) -> bool:
    """Whether the arm lowers the hand there straight from above, and the hand stays clear of everything.

    A careful set-down also keeps what is held upright on the way, and leaves it straight back along the approach; a
    gentle one tips it by no more than 25 degrees.
    """
    careful = care == "careful"
    grasp = scene.plan.grasp
    pose = Grasp(
        position=option.position,
        approach=option.approach,
        yaw=option.yaw,
        aperture=grasp.aperture,
        force=grasp.force,
        type=grasp.type,
        standoff=RETREAT if careful else 0.02,
    )
    if meets(pose, scene.points_w, scene.met):
        return False
    if not scene.has_arm:
        return True
    target = np.eye(4)
    target[:3, :3], target[:3, 3] = pose.rotation(), option.position
    # The robot takes the first way that it finds, so that one must be clear.
    stages = STAGES if care == "any" else GENTLE
    way = way_down(target, scene.joints, scene.boxes, scene.load, calm=careful, stages=stages)
    if way is None or not _clear(way.path[::2], scene.points_w):
        return False
    if not careful or abs(option.approach[2]) > UPRIGHT_HAND:
        return True
    back = way_back(forward(way.path[-1]), -np.asarray(option.approach), RETREAT, way.path[-1])
    return back is not None and _clear(back[::2], scene.points_w)


def _clear(path: Array, points_w: Array) -> bool:
    return not len(points_w) or path_clearance(path, points_w) >= ARM_GAP


def load_points(held: PerceivedObject, plan: Plan) -> tuple[Vec3, ...]:
    """Middles of spheres that fill the box of what is held, in the hand frame [m]."""
    axes: list[Array] = []
    for extent in held.size:
        reach = max(0.0, extent / 2 - CARRIED_RADIUS)
        axes.append(np.linspace(-reach, reach, 1 if reach == 0.0 else math.ceil(2 * reach / SPHERE_STEP) + 1))
    local: Array = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    world: Array = np.array([_turned(point, held.yaw) for point in local.tolist()]) + np.asarray(held.position)
    in_hand = (world - np.asarray(plan.grasp.position)) @ hand_at_grasp(plan)
    return tuple(vec3(in_hand[k] + np.array([0.0, 0.0, TCP_OFFSET])) for k in range(len(in_hand)))


def points_of(percept: Percept, without: tuple[str, ...] = ()) -> Array:
    """Surface points of everything perceived, and of the bin's walls, shape (N, 3) [m]."""
    clouds = [completed(other) for other in percept.objects if other.id not in without]
    if percept.bin is not None:
        clouds.append(bin_points(percept.bin))
    return np.concatenate(clouds) if clouds else np.zeros((0, 3))


def bin_points(corners: tuple[Vec3, Vec3]) -> Array:
    """Points on the walls of the bin, 10 mm apart, shape (N, 3) [m]."""
    low, high = np.asarray(corners[0]), np.asarray(corners[1])
    xs, ys, zs = (np.arange(a, b + 0.005, 0.010) for a, b in zip(low, high, strict=True))
    sides = [np.stack(np.meshgrid([x], ys, zs, indexing="ij"), -1).reshape(-1, 3) for x in (low[0], high[0])]
    sides += [np.stack(np.meshgrid(xs, [y], zs, indexing="ij"), -1).reshape(-1, 3) for y in (low[1], high[1])]
    return np.concatenate(sides)


def _turned(vector: Sequence[float], angle: float) -> Vec3:
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y, z = vector
    return cosine * x - sine * y, sine * x + cosine * y, z
