"""What an object of no known category affords, judged by its geometry and appearance (Sec. III-A's eight types).

Each rule names one type, and says how clearly its thresholds are met. Fragility cannot be seen: it is an interval, and the
descriptor carries the value that retrieval compares.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.affordance import FRAGILE_NEIGHBOUR, AffordanceDescriptor
from kb.percept import Part
from kb.vocabulary import AffordanceType, Material, Region
from tools.perception.blob import HIDDEN
from tools.perception.measure import Measured

THIN_WALL = 0.013
"""Rims up to this thick are gripped at the edge [m]: 8 mm of a wall that leans by 40 degrees looks so thick."""

FLAT, SLIM, SMALL = 0.023, 0.040, 0.028
"""Heights of flat things, widths of slim ones, and extents of things to be pinched [m]."""

FRAGILE_GLASS, CAREFUL, STURDY = 0.8, 0.3, 0.1
"""Fragility taken for what is transparent or thin-stemmed, for most things, and for tools."""
RANGES: dict[AffordanceType, tuple[float, float]] = {
    "FRAGILE": (0.5, 0.95),
    "GRASPABLE_HANDLE": (0.1, 0.6),
    "GRASPABLE_EDGE": (0.1, 0.6),
    "CLAMPABLE": (0.1, 0.6),
    "WRAPPABLE": (0.0, 0.9),
    "GRASPABLE_BODY": (0.0, 0.6),
    "TOOL_HANDLE": (0.0, 0.3),
    "PINCHABLE": (0.0, 0.3),
}
"""Plausible fragility by type: what is round and closed may be an egg or a ball."""
SUREST = 0.95
"""Clarity of a rule whose thresholds are far away: geometry alone is never certain."""
BLUR = 0.15
"""Relative error of a measured extent that the clarity of a rule reckons with."""
BOOK, BOOK_HIGH = 0.040, 2.0
"""What is thinner than this [m] and this many times as high and half as many times as long as thick stands on its edge."""
ROUNDED = (0.70, 0.87)
"""Share of its rectangle that an ellipse fills (0.785), with the errors of outlines."""


THIN, LONGEST_PLATE = 0.014, 0.20
"""Height of a thin plate, and the length up to which it may be a device [m]."""

TILTED = 0.95
"""|cosine| between a plate's normal and the vertical below which it does not lie flat (18 degrees)."""

PLATE = 0.004
"""Standard deviation across a thin plate of which one or both faces are seen [m]: half a phone's 10 mm, and noise."""

PLATE_WIDTH = 0.012
"""Standard deviation along the shorter side from which on a thin thing is a plate and no bar [m]."""


def leans_as_plate(points: NDArray[np.float64]) -> bool:
    """Whether the points (N, 3) [m] lie on a thin plate that leans or stands on its edge."""
    if len(points) < 30:
        return False
    spread, axes = np.linalg.eigh(np.cov((points - points.mean(axis=0)).T))
    thin, wide, _ = np.sqrt(np.maximum(spread, 0.0))
    return bool(thin < PLATE and wide > PLATE_WIDTH and abs(axes[2, 0]) < TILTED)


@dataclass(frozen=True)
class Afforded:
    """What an unknown object seems to afford."""

    descriptor: AffordanceDescriptor
    confidence: float
    """How clearly the rule's thresholds are met, in (0, 1)."""
    fragility_range: tuple[float, float]


def _is_thin_plate(m: Measured) -> bool:
    """Whether the thing is a wide plate that lies flat."""
    longer, shorter, height = (float(value) for value in m.box.size)
    return not m.is_round and height < THIN and shorter > SLIM and longer < LONGEST_PLATE


def affordance_of_unknown(measured: Measured, parts: tuple[Part, ...], *, transparent: bool) -> Afforded:
    """What an unknown object affords, with its uncertainty.

    Args:
        measured: Its measurements.
        parts: Its parts, as measured.
        transparent: Whether it is clear.
    """
    regions: dict[Region, Part] = {part.region: part for part in parts}
    seen_from_above = float(measured.blob.from_top.mean()) >= HIDDEN
    leans = seen_from_above and leans_as_plate(measured.blob.xyz)  # else: the front of what carries something
    if not transparent and "stem" not in regions and (leans or _is_thin_plate(measured)):
        # A thin plate is as breakable as the one clampable thing of Table I; if it leans, it falls when touched.
        found = AffordanceDescriptor(type="CLAMPABLE", material="mixed", fragility=FRAGILE_NEIGHBOUR, region="edge")
        return Afforded(found, 0.7, RANGES["CLAMPABLE"])
    kind, region, clarity = _type_and_region(measured, regions, transparent)
    material: Material = "glass" if transparent else "mixed"
    fragility = FRAGILE_GLASS if kind == "FRAGILE" else STURDY if kind in ("TOOL_HANDLE", "PINCHABLE") else CAREFUL
    found = AffordanceDescriptor(type=kind, material=material, fragility=fragility, region=region)
    return Afforded(found, round(min(clarity, SUREST), 3), RANGES[kind])


def _type_and_region(m: Measured, parts: dict[Region, Part], transparent: bool) -> tuple[AffordanceType, Region, float]:
    """The first rule that holds: type, region, and how clearly it holds."""
    longer, shorter, height = (float(value) for value in m.box.size)
    if "stem" in parts:
        return "FRAGILE", "stem", 0.9 * parts["stem"].confidence
    if transparent:
        return "FRAGILE", "neck" if "neck" in parts else "body", 0.7
    if "handle" in parts:
        handle = parts["handle"]
        return ("GRASPABLE_HANDLE" if handle.outward is not None else "TOOL_HANDLE"), "handle", 0.9 * handle.confidence
    if "rim" in parts and parts["rim"].width < THIN_WALL:
        return "GRASPABLE_EDGE", "rim", _below(parts["rim"].width, THIN_WALL)
    if max(shorter, height) < SMALL and longer < 0.10:
        return "PINCHABLE", "body", _below(max(shorter, height), SMALL)
    if longer > 3.0 * shorter and shorter < SLIM and height < SLIM:
        return "TOOL_HANDLE", "body", min(_below(shorter, SLIM), _below(3.0 * shorter, longer))
    if height < FLAT and shorter > 0.030:
        return "CLAMPABLE", "edge", _below(height, FLAT)
    if shorter < BOOK and height > BOOK_HIGH * shorter and longer > BOOK_HIGH * shorter and not m.is_round:
        return "CLAMPABLE", "edge", _below(BOOK_HIGH * shorter, min(height, longer))
    if m.is_ball or (m.is_round and height < 1.3 * longer and not m.hollow) or is_rounded(m):
        return "WRAPPABLE", "body", 0.8
    return "GRASPABLE_BODY", "body", 0.6


def is_rounded(m: Measured) -> bool:
    """Whether a thing of no special shape is rounded all over: an egg, a bulb, a plush animal, and no brick."""
    if m.is_round or m.hollow:
        return False
    longer, shorter, height = (float(value) for value in m.box.size)
    fill = m.outline.hull_area / (longer * shorter)
    return ROUNDED[0] < fill < ROUNDED[1] and longer < 2.6 * shorter and height < 2.0 * shorter


def _below(value: float, limit: float) -> float:
    """Probability that a value, measured with the relative error `BLUR`, is truly below the limit."""
    return 0.5 * (1.0 + math.erf((limit / value - 1.0) / (BLUR * math.sqrt(2.0))))
