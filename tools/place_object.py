"""Put down what is held: into the bin, at a point, on a side of the table, beside or on something else.

The place is chosen on the percept: free of other objects, within the arm's reach, with room for the hand. The object is
lowered upright until the wrist feels the ground.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import islice
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kb.base import Noun, Vec2
from kb.by_identity import ByIdentity
from kb.errors import BadInputError
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan, Sensing
from tools.context import ToolContext
from tools.planning.bin_places import bin_places
from tools.planning.lane_places import LEAST_GAP, lane_places
from tools.planning.obstacles import obstacles, set_down_box
from tools.planning.set_down import (
    GAP,
    Care,
    Scene,
    SetDown,
    feasible,
    footprint_radius,
    is_free,
    load_points,
    points_of,
    set_downs,
    spiral,
)

Place = Literal["bin", "point", "side", "beside", "on", "aside", "hand_over"]
Side = Literal["left", "right", "front", "back", "middle"]
Relation = Literal["near", "left_of", "right_of", "behind", "in_front_of", "nearest_to", "touching", "between"]

SIDES: dict[Side, Vec2] = {
    "left": (0.48, 0.27),
    "right": (0.48, -0.27),
    "front": (0.36, 0.0),
    "back": (0.66, 0.0),
    "middle": (0.50, 0.0),
}
"""Middles of the table's regions as seen from the robot [m]: y points to its left, x away from it."""
BESIDE_GAP = 0.05
"""Surface gap wanted when something is put next to something [m]."""
NEVER_TIPPED = 0.7
"""Things at least this fragile are carried no more crookedly than a gentle way takes them."""
SLOWEST = 0.15
"""Least velocity scale of a set-down: 6 mm/s at the end, a wine glass then lands with less than 5 N."""
TRIES = 60
"""Poses whose reach is checked before giving up."""


class PlaceArgs(Noun):
    """Arguments of `place_object`."""

    percept: Percept
    """What stands where now; the held object is not in it, or is left out by its id."""
    held: Plan
    """The plan with which the object was gripped."""
    object: PerceivedObject
    """The object as it stood before it was taken."""
    kind: Place
    point: Vec2 | None = None
    """Wanted centre of the footprint for "point" [m]; the nearest free place is taken."""
    side: Side | None = None
    """Part of the table for "side"."""
    reference: str | None = None
    """Perceived id for "beside" and "on"."""
    relation: Relation = "near"
    """Which side of the reference."""
    slot: Annotated[int, Field(ge=0)] = 0
    """How many things were already put there: they are spread inside the bin."""
    keep_in: tuple[Vec2, Vec2] | None = None
    """Corners of a rectangle in which the centre must lie (a lane) [m]."""
    to_take: tuple[str, ...] = ()
    """Perceived ids of what is still to be gripped: in a lane, room for the hand is left beside it where there is some."""
    lying: tuple[PerceivedObject, ...] = ()
    """What was put into the bin before, as it should lie there: no camera sees over the walls."""


def place_object(args: PlaceArgs, context: ToolContext) -> Sensing:
    """Sets the held object down.

    Args:
        args: What is held, where to, and what stands around.
        context: The robot.

    Returns:
        What was sensed; `stopped_by` "path" with phase "plan" if no free place is within reach.

    Raises:
        BadInputError: if a needed point, side, reference or bin is missing.
    """
    boxes = obstacles(args.percept, without=(args.object.id,))
    if args.kind == "hand_over":
        return context.robot.handover(boxes, load=load_points(args.object, args.held))
    chosen = choose_place(args, context)
    if chosen is None:
        return Sensing(reachable=False, stopped_by="path", phase="plan", aperture_end=float(context.robot.aperture))
    sensing = context.robot.place(
        chosen.position,
        approach=chosen.approach,
        yaw=chosen.yaw,
        obstacles=boxes,
        speed=set_down_speed(args),
        left_behind=set_down_box(args.object, chosen, args.held),
        load=load_points(args.object, args.held),
    )
    return sensing.model_copy(update={"aimed_at": chosen.centre, "turned": chosen.turn})


def set_down_speed(args: PlaceArgs) -> float:
    """Velocity scale of the set-down: the more fragile, the slower it lands; never faster than it was grasped."""
    return min(args.held.grasp.speed, max(SLOWEST, 1.0 - args.object.affordance.fragility))


def choose_place(args: PlaceArgs, context: ToolContext) -> SetDown | None:
    """The first free, reachable place in the order of preference, or None.

    Places that can be reached and left without tipping or brushing what is held go before all others. Neither hand nor
    thing is to meet what lies in the bin, unless there is no other place left: then it goes on top.
    """
    chosen = _chosen(args, context)
    return _chosen(args.model_copy(update={"lying": ()}), context) if chosen is None and args.lying else chosen


def _chosen(args: PlaceArgs, context: ToolContext) -> SetDown | None:
    """As `choose_place`, kept: configurations of a trial that hold the same thing alike ask for the same place."""
    place = args.kind, args.point, args.side, args.reference, args.relation, args.slot, args.keep_in, args.to_take
    hand = args.held.grasp, args.held.joints, tuple(context.robot.joints), getattr(context.robot, "has_arm", True)
    around = (*args.percept.objects, args.object, *args.lying)
    also = len(args.lying), args.percept.bin, place, hand
    return _places.get(around, also, lambda: _found(args, context))


_places: ByIdentity[SetDown | None] = ByIdentity(16)
"""Everything perceived, what is held, where to and how -> the place."""


def _found(args: PlaceArgs, context: ToolContext) -> SetDown | None:
    without = (args.object.id,)
    known = args.percept.model_copy(update={"objects": (*args.percept.objects, *args.lying)})
    scene = Scene(
        plan=args.held,
        joints=np.asarray(context.robot.joints, float),
        points_w=points_of(known, without=without),
        boxes=obstacles(args.percept, without=without),
        load=np.asarray(load_points(args.object, args.held)),
        has_arm=bool(getattr(context.robot, "has_arm", True)),
    )
    options, looked = _options(args), list[SetDown]()
    for care, limit in _cares(args):
        for option in _first(options, looked, limit):
            if feasible(option, scene, care):
                return option
    return None


def _first(options: Iterator[SetDown], looked: list[SetDown], limit: int) -> Iterator[SetDown]:
    """The first `limit` options: those that were looked at with another care, and then new ones."""
    yield from looked[:limit]
    for option in islice(options, max(0, limit - len(looked))):
        looked.append(option)
        yield option


def _cares(args: PlaceArgs) -> tuple[tuple[Care, int], ...]:
    """The ways to carry it that are looked for, in order, and how many poses of the hand are tried with each.

    What is brittle is never tipped far: it would slide out of a hand that may press but little.
    """
    careful: tuple[tuple[Care, int], ...] = (("careful", TRIES * (8 if args.keep_in else 4)), ("gentle", TRIES))
    brittle = args.object.affordance.fragility >= NEVER_TIPPED
    return careful if brittle else (*careful, ("any", TRIES * 12))


def _options(args: PlaceArgs) -> Iterator[SetDown]:
    """Hand poses in the order of preference."""
    if args.kind == "bin":
        yield from _in_bin(args)
        return
    ignore = (args.object.id,)
    support = 0.0
    if args.kind == "on":
        below = _reference(args)
        support, centres = below.top_z, iter([(below.position[0], below.position[1])])
        yield from set_downs(args.object, args.held, next(centres), support)
        return
    if args.keep_in is not None:
        yield from lane_places(args.object, args.held, args.percept, args.keep_in, args.to_take)
        return
    radius = footprint_radius(args.object)
    places = 0
    for gap in (GAP, LEAST_GAP):
        for centre in _wanted(args):
            if is_free(centre, radius, args.percept, ignore, gap, args.object.size[2] + GAP):
                yield from set_downs(args.object, args.held, centre, support)
                places += 1
                if places >= TRIES:
                    return


def _wanted(args: PlaceArgs) -> Iterator[Vec2]:
    """Centres of footprints, most wanted first."""
    if args.kind == "point":
        if args.point is None:
            raise BadInputError("a point is needed", where="point")
        yield from spiral(args.point)
    elif args.kind == "side":
        if args.side is None:
            raise BadInputError("a side is needed", where="side", choices=list(SIDES))
        yield from spiral(SIDES[args.side])
    elif args.kind == "beside":
        yield from _around(args)
    else:
        # Aside: anywhere, near where it stood but out of its place.
        x, y, _ = args.object.position
        for distance in (0.16, 0.20, 0.24, 0.28, 0.32):
            for k in range(16):
                angle = 2 * math.pi * k / 16
                yield x + distance * math.cos(angle), y + distance * math.sin(angle)


def _around(args: PlaceArgs) -> Iterator[Vec2]:
    """Places around the reference: on the wanted side first, then fanning out from it."""
    other = _reference(args)
    bearings = {"left_of": math.pi / 2, "right_of": -math.pi / 2, "behind": 0.0, "in_front_of": math.pi}
    radius = footprint_radius(args.object) + 0.5 * math.hypot(other.size[0], other.size[1])
    wanted = bearings.get(args.relation)
    start = wanted if wanted is not None else math.atan2(-other.position[1], 0.48 - other.position[0])
    widest = math.radians(40.0) if wanted is not None else math.pi
    for gap in (BESIDE_GAP, 0.035, 0.07):
        for k in range(13):
            fan = widest * ((k + 1) // 2) / 6 * (1 if k % 2 else -1)
            angle = start + fan
            yield (
                other.position[0] + (radius + gap) * math.cos(angle),
                other.position[1] + (radius + gap) * math.sin(angle),
            )


def _in_bin(args: PlaceArgs) -> Iterator[SetDown]:
    if args.percept.bin is None:
        raise BadInputError("there is no bin in this scene", where="bin")
    others = [other for other in (*args.percept.objects, *args.lying) if other.id != args.object.id]
    return bin_places(args.object, args.held, others, args.percept.bin, args.slot)


def _reference(args: PlaceArgs) -> PerceivedObject:
    try:
        return args.percept.object(args.reference or "")
    except KeyError:
        seen = [item.id for item in args.percept.objects]
        raise BadInputError(f"no object {args.reference!r} in this percept", where="reference", choices=seen) from None
