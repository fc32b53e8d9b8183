"""Grasps of a whole body: from above across its narrow side, tilted along it, and from the side for tall things."""

from __future__ import annotations

import math

import numpy as np

from kb.base import Vec3
from kb.percept import PerceivedObject
from kb.vocabulary import GraspType, Region
from tools.planning.candidate import (
    PAD_HALF_WIDTH,
    PALM_DEPTH,
    PALM_HALF_WIDTH,
    PALM_MARGIN,
    TABLE_MARGIN,
    TIP_REACH,
    Array,
    Candidate,
    degrees,
    depth_of,
    horizontal,
    leaning,
    wrap,
)
from tools.planning.section import section

ROUND_YAWS = 8
"""Closing axes tried around a round thing: every 22.5 degrees."""
TILTS = (0.0, math.radians(15), math.radians(-15), math.radians(35), math.radians(-35))
"""Tilts of a top grasp within the plane of the fingers [rad]."""
_TILT_NAMES = {tilt: "" if tilt == 0.0 else f"/tilt{degrees(tilt)}" for tilt in TILTS}
SIDE_BEARINGS = tuple(math.radians(a) for a in (11, -11, 23, -23, 35, -35, 50, -50, 70, -70, 90, -90))
"""Bearings of a side approach off the radial direction [rad]; exactly radial ones can't lift (physics.md)."""
SIDE_DIPS = tuple(math.radians(a) for a in (0, 10, 20))
"""How far a side approach points down [rad]."""
MOST_BACK = 0.007
"""A thick body is gripped at most this far before its middle [m]."""
THIN, EDGE_HOLD = 0.045, 0.014
"""Bodies up to this thick [m] may be held by an edge, the tool point at least so far inside of it [m]."""
TALL = 0.060
"""Objects at least this high can be taken from the side [m]."""
LOW_TOP = 0.125
"""Higher objects aren't taken by the body from above: the fingers would only reach their upper end [m]."""


def is_round(subject: PerceivedObject) -> bool:
    """Whether every horizontal direction has the same width."""
    return subject.shape in ("sphere", "cylinder", "bowl") and subject.size[0] - subject.size[1] < 0.012


def body_candidates(subject: PerceivedObject, region: Region) -> list[Candidate]:
    """All body grasps of an object, labelled with `region` (an edge grasp of a flat thing is a body grasp)."""
    found: list[Candidate] = []
    thin = subject.shape in ("box", "plate", "bar") and subject.size[1] <= THIN
    if subject.size[2] <= LOW_TOP or thin:
        found += top_candidates(subject, region)
    if subject.size[2] >= TALL:
        found += side_candidates(subject, region)
    return found


def tip_floor(subject: PerceivedObject, tilt: float) -> float:
    """Lowest height of the tool point at which the fingertips stay off the support below [m]."""
    support = subject.base_z if subject.base_z > 0.012 else 0.0
    tilt = abs(tilt)
    return support + TABLE_MARGIN + TIP_REACH * math.cos(tilt) + PAD_HALF_WIDTH * math.sin(tilt)


def palm_floor(top: float, tilt: float) -> float:
    """Lowest height of the tool point at which the palm's lower edge stays above `top` [m]."""
    tilt = abs(tilt)
    return top + PALM_MARGIN - PALM_DEPTH * math.cos(tilt) + PALM_HALF_WIDTH * math.sin(tilt)


def top_candidates(subject: PerceivedObject, region: Region) -> list[Candidate]:
    """Grasps from above, closing across the object."""
    points_w = subject.surface_points()
    floors = [max(tip_floor(subject, tilt), palm_floor(subject.top_z, tilt)) for tilt in TILTS]
    rounded = is_round(subject)
    found: list[Candidate] = []
    for label, closing_yaw, width, along, offset in _closings(subject):
        origin = np.asarray(subject.position) + along * offset
        if subject.shape not in ("sphere", "cylinder"):
            origin, width = _refine(subject, points_w, origin, horizontal(closing_yaw), width)
        lean = [leaning(wrap(closing_yaw) + math.pi / 2, tilt) for tilt in TILTS]
        for type_ in ("power", "pinch"):
            for tilt, floor, approach in zip(TILTS, floors, lean, strict=True):
                found.append(
                    _top(
                        subject,
                        region,
                        type_,
                        label,
                        closing_yaw,
                        origin,
                        width,
                        tilt,
                        offset,
                        floor,
                        approach,
                        rounded,
                    )
                )
    return found


def _closings(subject: PerceivedObject) -> list[tuple[str, float, float, Array, float]]:
    """Closing axes: label, azimuth [rad], width [m], direction and offset [m] of the place along the object."""
    long, short, _ = subject.size
    if is_round(subject):
        mean = (long + short) / 2
        return [
            (f"yaw{k * 180 // ROUND_YAWS}", wrap(math.pi * k / ROUND_YAWS), mean, horizontal(0.0), 0.0)
            for k in range(ROUND_YAWS)
        ]
    along = horizontal(subject.yaw)
    # Long things may be taken beside their middle when something stands in the way there.
    offsets = (0.0, 0.08, -0.08, 0.15, -0.15, 0.22, -0.22, 0.3, -0.3, 0.38, -0.38) if long > 0.09 else (0.0,)
    found = [(f"across{round(100 * f):+d}", wrap(subject.yaw + math.pi / 2), short, along, f * long) for f in offsets]
    found.append(("along", wrap(subject.yaw), long, along, 0.0))
    return found


def _refine(
    subject: PerceivedObject, points_w: Array, origin: Array, closing_w: Array, width: float
) -> tuple[Array, float]:
    """Centres the grasp on the observed section (a banana's middle isn't its box's), if the section is plausible."""
    seen = section(points_w, origin, closing_w, half=0.012, low=subject.base_z, high=subject.top_z + 0.01)
    if seen is None or not 0.35 * width <= seen.width <= 1.1 * width:
        return origin, width
    if subject.shape == "box" and seen.width > 0.85 * width:
        # A box's own fit is better than the extremes of noisy points.
        return origin, width
    return origin + closing_w * seen.shift, seen.width


def _top(
    subject: PerceivedObject,
    region: Region,
    type_: GraspType,
    label: str,
    closing_yaw: float,
    origin: Array,
    width: float,
    tilt: float,
    offset: float,
    floor: float,
    approach: Vec3,
    rounded: bool,
) -> Candidate:
    middle = float(origin[2])
    # Fingertips reach the equator of round things from above it (ledger G35); others are held at half height, or, in a
    # pinch, near the top with the pads just covered.
    pinched = max(middle, subject.top_z - 0.014)
    height = max(floor, middle if type_ == "power" or subject.shape == "sphere" else pinched)
    overhang = max(0.0, height - TIP_REACH - middle) if rounded else 0.0
    small = width < 0.035
    return Candidate(
        name=f"{region}/top/{type_}/{label}{_TILT_NAMES[tilt]}",
        region=region,
        type="side" if abs(tilt) > math.radians(30) and type_ == "power" else type_,
        position=(float(origin[0]), float(origin[1]), height),
        approach=approach,
        yaw=closing_yaw,
        width=width,
        miss=abs(offset) * 0.5 + overhang,
        depth=depth_of(subject, height),
        merit=-0.35 * min(1.0, abs(tilt) / math.radians(35))
        - 1.6 * min(1.5, abs(offset) / 0.05)
        - (0.15 if small == (type_ == "power") else 0.0),
    )


def side_floor(dip: float) -> float:
    """Lowest height of the tool point of a side grasp at which hand and flange stay off the table [m]."""
    sine, cosine = math.sin(dip), math.cos(dip)
    palm = 0.004 + max(PALM_HALF_WIDTH * cosine - PALM_DEPTH * sine, 0.0315 * cosine - 0.083 * sine)
    # The flange is 50 mm in radius and 104 mm behind the tool point.
    flange = 0.006 + 0.050 * cosine - 0.104 * sine
    tips = TABLE_MARGIN + TIP_REACH * sine + PAD_HALF_WIDTH * cosine
    return max(palm, flange, tips)


def side_candidates(subject: PerceivedObject, region: Region) -> list[Candidate]:
    """Grasps from the side at the middle of the body, a little above and a little below."""
    body = subject.part("body")
    centre = np.asarray(subject.position)
    round_body = is_round(subject) or (body is not None and body.radius is not None and subject.shape != "box")
    if body is not None and round_body:
        centre = np.array([body.centre[0], body.centre[1], centre[2]])
    width = body.width if body is not None and round_body else subject.size[1]
    found: list[Candidate] = []
    for share in (0.5, 0.62, 0.38):
        height = subject.base_z + share * subject.size[2]
        found += side_grips(
            subject, region, f"h{round(100 * share)}", centre, height, width, None if round_body else subject.yaw
        )
    return found


def side_grips(
    subject: PerceivedObject,
    region: Region,
    label: str,
    centre: Array,
    height: float,
    width: float,
    long_axis: float | None,
    *,
    dips: tuple[float, ...] = SIDE_DIPS,
    best_dip: float = 0.0,
) -> list[Candidate]:
    """Side grasps at one height, around the radial direction or, for a box, along its two faces.

    Args:
        subject: The object.
        region: Region that these grasps hold.
        label: Part of the candidates' names.
        centre: Point on the axis that is gripped, shape (3,); its height is ignored [m].
        height: Wanted height of the tool point [m].
        width: Width between the pads [m].
        long_axis: Azimuth of the longer horizontal axis of a box [rad]; None for round things.
        dips: How far the approach may point down [rad].
        best_dip: The dip without malus [rad].
    """
    radial = math.atan2(centre[1], centre[0])
    bearings: list[tuple[float, float]]
    if long_axis is None:
        bearings = [(radial + off, width) for off in SIDE_BEARINGS]
    else:
        faces = [(long_axis + k * math.pi / 2, width if k % 2 == 0 else subject.size[0]) for k in range(4)]
        bearings = [(a, w) for a, w in faces if abs(math.remainder(a - radial, 2 * math.pi)) < math.radians(100)]
    found: list[Candidate] = []
    x, y = float(centre[0]), float(centre[1])
    lowest = {dip: floor for dip in dips if (floor := side_floor(dip)) <= subject.top_z - PAD_HALF_WIDTH}
    for bearing, local in bearings:
        # The palm must not touch the body: pads that grip behind the middle leave it room. Of a thin upright thing (a
        # book) they hold the edge that faces the hand.
        along = width if long_axis is None else (subject.size[0] if local < subject.size[0] else subject.size[1])
        most = MOST_BACK if long_axis is None or local > THIN else along / 2 - EDGE_HOLD
        back = min(most, max(0.0, along / 2 + 0.006 - PALM_DEPTH))
        off = math.remainder(bearing - radial, 2 * math.pi)
        forward, sideways = math.cos(bearing), math.sin(bearing)
        for dip, floor in lowest.items():
            actual = max(height, floor)
            level = math.cos(dip)
            ahead, beside, down = forward * level, sideways * level, 0.0 - math.sin(dip)
            found.append(
                Candidate(
                    name=f"{region}/side/{label}/bearing{degrees(off)}/dip{degrees(dip)}",
                    region=region,
                    type="side",
                    position=(x - ahead * back, y - beside * back, actual - down * back),
                    approach=(ahead, beside, down),
                    yaw=wrap(bearing + math.pi / 2),
                    width=local,
                    miss=abs(actual - height) * 0.5,
                    depth=depth_of(subject, actual),
                    merit=-0.25 * abs(off) / math.radians(90)
                    - 0.2 * abs(dip - best_dip) / math.radians(20)
                    - min(0.4, 8.0 * abs(actual - height)),
                )
            )
    return found
