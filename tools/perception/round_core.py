"""The round body of a thing from which more than a handle sticks out: a teapot or a watering can has a spout, too.

Seen from above, most directions end at one circle; the few that reach farther are protrusions. The one that is tall where
it ends is a loop handle; what rises outwards is a spout.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kb.percept import Part
from tools.perception import sections
from tools.perception.measure import Measured
from tools.perception.parts import LOOP

Array = NDArray[np.float64]

DIRECTIONS = 72
"""Azimuths at which the reach is taken (5 degrees apart)."""
STICKS_OUT = 0.009
"""What reaches this far beyond the circle sticks out of it [m], as a loop handle of a cup does."""
MOST_OUT = 0.40
"""Share of directions that may stick out."""
ROUGHEST = 0.05
"""Largest mean deviation of the other directions from the circle, over its radius."""
WIDEST = 70.0
"""A protrusion that takes more degrees than this is part of the body."""
SPOUT_SLOPE, SPOUT_LINE = 0.6, 0.8
"""Rise per distance outwards of a spout at least, and how well its points follow that line (correlation)."""
OUTER = 0.012
"""What lies within this of a protrusion's end tells how tall it is there [m]."""


@dataclass(frozen=True)
class _Protrusion:
    azimuth: float
    reach: float
    tall: float
    """Height over which its outer end is seen [m]."""
    middle: float
    """Mean height of its outer end [m]."""
    spout: bool = False
    """It rises outwards."""


def round_core(m: Measured) -> Measured | None:
    """The same thing measured as a round body with a handle, or None if it has no round body."""
    above = m.blob.xyz[m.blob.from_top]
    if m.is_round or m.is_ball or len(above) < 200:
        return None
    fitted = _circle(above[:, :2])
    if fitted is None:
        return None
    centre, radius, reach = fitted
    found = _protrusions(m.blob.xyz, centre, radius, reach)
    if not found:
        return None
    handle = max(found, key=lambda item: (not item.spout, round(item.tall, 2), -item.middle))
    hollow, wall, rim = sections.hollow(m.blob, centre, radius, m.base, m.top)
    return replace(
        m,
        is_round=True,
        centre=centre,
        radius=radius,
        bulge=handle.reach - radius,
        bulge_azimuth=handle.azimuth,
        profile=sections.profile(m.blob, centre, m.base, max(m.top - m.base, 1e-3)),
        hollow=hollow,
        wall=wall,
        rim_radius=rim,
    )


def has_loop(parts: tuple[Part, ...]) -> bool:
    """Whether there is a loop handle among the parts; a round body with a stub has none."""
    return any(part.outward is not None and not is_stub(part) for part in parts)


def is_stub(part: Part) -> bool:
    """Whether what sticks out is about as thick as tall: a foot or a bulb's base, no loop."""
    return part.region == "handle" and part.outward is not None and part.length <= LOOP * part.width


def _circle(xy: Array) -> tuple[Array, float, Array] | None:
    """Centre (2,), radius, and reach (DIRECTIONS,) about the centre of a circle that most directions end at, or None."""
    centre = np.median(xy, axis=0)
    radius, reach = 0.0, np.zeros(DIRECTIONS)
    for _ in range(8):
        reach = _reach(xy - centre)
        radius = float(np.median(np.sort(reach)[: round((1.0 - MOST_OUT) * DIRECTIONS)]))
        inner = reach < radius + 0.6 * STICKS_OUT
        angles = np.arange(DIRECTIONS)[inner] * (2 * np.pi / DIRECTIONS)
        unit = np.column_stack([np.cos(angles), np.sin(angles)])
        # reach = radius + shift . unit, for a circle whose centre lies `shift` off the assumed one.
        shift, *_ = np.linalg.lstsq(np.column_stack([unit, np.ones(len(unit))]), reach[inner], rcond=None)
        centre, radius = centre + shift[:2], float(shift[2])
        if np.hypot(*shift[:2]) < 2e-4:
            break
    inner = reach < radius + STICKS_OUT
    if radius < 0.02 or inner.mean() < 1.0 - MOST_OUT:
        return None
    if float(np.abs(reach[inner] - radius).mean()) > ROUGHEST * radius:
        return None
    return centre, radius, reach


def _reach(offset: Array) -> Array:
    """Farthest distance of points (N, 2) in each direction, without the two farthest (DIRECTIONS,) [m]."""
    distance = np.hypot(offset[:, 0], offset[:, 1])
    step = 2 * np.pi / DIRECTIONS
    sector = np.round(np.arctan2(offset[:, 1], offset[:, 0]) / step).astype(int) % DIRECTIONS
    reach = np.zeros(DIRECTIONS)
    for k in range(DIRECTIONS):
        mine = np.sort(distance[sector == k])
        reach[k] = mine[-3] if len(mine) >= 3 else (mine[-1] if len(mine) else 0.0)
    return reach


def _protrusions(xyz: Array, centre: Array, radius: float, reach: Array) -> list[_Protrusion]:
    """Runs of neighbouring directions that stick out, each with its end."""
    out = reach > radius + STICKS_OUT
    if not out.any() or out.all():
        return []
    start = int(np.flatnonzero(~out)[0])
    found: list[_Protrusion] = []
    run: list[int] = []
    for k in [*range(start, start + DIRECTIONS), start]:
        if out[k % DIRECTIONS]:
            run.append(k % DIRECTIONS)
            continue
        if run and 360.0 / DIRECTIONS * len(run) <= WIDEST:
            found.append(_protrusion(xyz, centre, radius, reach, run))
        run = []
    return found


def _protrusion(xyz: Array, centre: Array, radius: float, reach: Array, run: list[int]) -> _Protrusion:
    step = 2 * np.pi / DIRECTIONS
    angles = np.array(run) * step
    excess = reach[run] - radius
    azimuth = float(np.arctan2(excess @ np.sin(angles), excess @ np.cos(angles)))
    farthest = float(reach[run].max())
    offset = xyz[:, :2] - centre
    along = offset @ np.array([np.cos(azimuth), np.sin(azimuth)])
    across = np.abs(offset @ np.array([-np.sin(azimuth), np.cos(azimuth)]))
    mine = (along > radius + 0.5 * STICKS_OUT) & (along < farthest + 0.004) & (across < 0.6 * radius)
    z = xyz[mine & (along > farthest - OUTER), 2]
    if len(z) < 4:
        return _Protrusion(azimuth, farthest, 0.0, 1.0)
    spout = _rises(along[mine], xyz[mine, 2])
    return _Protrusion(azimuth, farthest, float(np.ptp(np.quantile(z, [0.05, 0.95]))), float(z.mean()), spout)


def _rises(along: Array, z: Array) -> bool:
    """Whether points rise outwards along one line."""
    if float(np.ptp(along)) < STICKS_OUT or float(np.ptp(z)) < STICKS_OUT:
        return False
    (spread, both), (_, rise) = np.cov(along, z)
    return bool(both > SPOUT_SLOPE * spread and both > SPOUT_LINE * np.sqrt(spread * rise))
