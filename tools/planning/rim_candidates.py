"""Grasps of an open vessel's wall: one finger inside, one outside, the hand tilted with the wall's draft."""

from __future__ import annotations

import math

import numpy as np

from kb.percept import Part, PerceivedObject
from kb.vocabulary import Region
from tools.planning.candidate import (
    FINGER_THICKNESS,
    TABLE_MARGIN,
    TIP_REACH,
    Array,
    Candidate,
    degrees,
    depth_of,
    horizontal,
    leaning,
    vec3,
    wrap,
)

AZIMUTHS = 16
"""Places tried around the rim."""
BOWL_DRAFT = math.radians(12.0)
"""Tilt of a bowl's wall off vertical where the surface doesn't tell [rad] (physics.md: 12.4 degrees)."""
MAX_DRAFT = math.radians(25.0)
"""Steeper tilts bring the palm down on the opposite rim [rad]."""
PLATE_DEPTH, PLATE_DRAFT = 0.025, math.radians(40.0)
"""An empty vessel shallower than the first [m] is a plate: nothing of it is in the palm's way, and its wall leans more [rad]."""
FLOOR_MARGIN = 0.003
"""Room between the inner fingertip and the floor of a shallow vessel, a plate's for instance [m]."""
SHALLOWEST = 0.004
"""The tool point is at least this far below the edge [m], however shallow the vessel is."""
GRIP_BELOW_RIM = 0.012
"""How far the tool point is below the rim's edge [m]: pads covered, palm 26 mm above."""
HANDLE_SECTOR = math.radians(32.0)
"""Azimuths nearer than this to a handle are left out [rad]."""
OPENING_MARGIN = 0.004
"""Room between the inner finger and the opposite wall [m]."""


def rim_candidates(subject: PerceivedObject, rim: Part, region: Region) -> list[Candidate]:
    """Grasps around the rim.

    Args:
        subject: The vessel.
        rim: Its rim: centre and radius of the circle at the height of the edge, wall thickness.
        region: Label of the candidates ("rim", or "edge" where the affordance calls it so).
    """
    if rim.radius is None:
        return []
    draft = wall_draft(subject, rim)
    # The wall's middle: perceived radii are those of the outer edge.
    radius = max(0.005, rim.radius - rim.width / 2)
    handle = subject.part("handle")
    blocked = math.atan2(handle.outward[1], handle.outward[0]) if handle and handle.outward else None
    # The inner finger needs its own thickness and half the opening between the wall and the opposite wall.
    room = 2.0 * (2.0 * radius - rim.width / 2 - FINGER_THICKNESS - OPENING_MARGIN)
    support = subject.base_z if subject.base_z > 0.012 else 0.0
    below = min(GRIP_BELOW_RIM, rim.centre[2] - support - TABLE_MARGIN - TIP_REACH - 0.005)
    below = min(below, max(SHALLOWEST, rim.length - TIP_REACH - FLOOR_MARGIN))
    if room <= rim.width + 0.012 or below < 0.002:
        return []
    tilts = sorted({draft, 0.0, BOWL_DRAFT, math.radians(25.0)} if subject.shape == "bowl" else {draft, 0.0})
    found: list[Candidate] = []
    for k in range(AZIMUTHS):
        azimuth = 2 * math.pi * k / AZIMUTHS
        if blocked is not None and abs(math.remainder(azimuth - blocked, 2 * math.pi)) < HANDLE_SECTOR:
            continue
        for tilt in tilts:
            found.append(_rim_grip(subject, rim, region, radius, azimuth, tilt, tilt - draft, below, room))
    return found


def _rim_grip(
    subject: PerceivedObject,
    rim: Part,
    region: Region,
    radius: float,
    azimuth: float,
    tilt: float,
    off_draft: float,
    below: float,
    room: float,
) -> Candidate:
    out = horizontal(azimuth)
    draft = tilt - off_draft
    point = np.asarray(rim.centre) + out * (radius - below * math.tan(draft))
    height = rim.centre[2] - below
    return Candidate(
        name=f"{region}/rim/az{degrees(math.remainder(azimuth, 2 * math.pi))}/tilt{degrees(tilt)}",
        region=region,
        type="pinch",
        position=vec3((point[0], point[1], height)),
        # Following the wall down leads inwards.
        approach=leaning(azimuth + math.pi, tilt),
        yaw=wrap(azimuth),
        width=rim.width,
        room=min(0.080, room),
        depth=depth_of(subject, height),
        merit=-min(0.6, abs(off_draft) / math.radians(30.0)),
    )


def wall_draft(subject: PerceivedObject, rim: Part) -> float:
    """Tilt of the outer wall off vertical near the rim [rad], from the observed surface, 12 degrees for a bowl without.

    The outer wall is what lies within 4 mm of the largest radius at its height; its radius is fitted over the upper
    35 mm, or the depth of a plate, by least squares.
    """
    fallback = BOWL_DRAFT if subject.shape == "bowl" else 0.0
    points_w = subject.surface_points()
    if rim.radius is None or len(points_w) == 0:
        return fallback
    offset = points_w[:, :2] - np.asarray(rim.centre)[:2]
    radius, height = np.hypot(offset[:, 0], offset[:, 1]), points_w[:, 2] - rim.centre[2]
    handle = subject.part("handle")
    plate = rim.length < PLATE_DEPTH and subject.state == "empty"
    keep = (height < 0.002) & (height > -(rim.length if plate else 0.035)) & (radius < rim.radius + 0.006)
    if handle is not None and handle.outward is not None:
        sideways = offset @ np.asarray(handle.outward)[:2]
        keep &= sideways < 0.8 * radius
    outer = _outermost(radius[keep], height[keep])
    if len(outer) < 4:
        return fallback
    heights, radii = outer[:, 0], outer[:, 1]
    spread = heights - heights.mean()
    if float(spread @ spread) < 2e-4:
        return fallback
    slope = float(spread @ (radii - radii.mean()) / (spread @ spread))
    return float(np.clip(math.atan(slope), 0.0, PLATE_DRAFT if plate else MAX_DRAFT))


def _outermost(radius: Array, height: Array) -> Array:
    """Largest radius per 5-mm band of height, rows (height, radius)."""
    rows: list[tuple[float, float]] = []
    for low in np.arange(-0.035, 0.0, 0.005):
        band = (height >= low) & (height < low + 0.005)
        if int(band.sum()) >= 4:
            rows.append((low + 0.0025, float(np.quantile(radius[band], 0.9))))
    return np.array(rows).reshape(-1, 2)
