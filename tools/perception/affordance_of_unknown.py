"""What an object of no known category affords, judged by its geometry alone (Sec. III-A's eight types)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kb.affordance import FRAGILE_NEIGHBOUR, AffordanceDescriptor
from kb.percept import Part
from kb.vocabulary import AffordanceType, Material, Region
from tools.perception.measure import Measured

THIN_WALL = 0.008
"""Rims up to this thick are gripped at the edge [m]."""

FLAT, SLIM, SMALL = 0.022, 0.040, 0.028
"""Heights of flat things, widths of slim ones, and extents of things to be pinched [m]."""

FRAGILE_GLASS, CAREFUL = 0.8, 0.3
"""Fragility taken for what is transparent or thin-stemmed, and for everything else that is not known."""


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


def affordance_of_unknown(measured: Measured, parts: tuple[Part, ...], *, transparent: bool) -> AffordanceDescriptor:
    """The affordance descriptor of an unknown object."""
    regions: dict[Region, Part] = {part.region: part for part in parts}
    kind, region = _type_and_region(measured, regions, transparent)
    if not transparent and "stem" not in regions and leans_as_plate(measured.blob.xyz):
        # A plate that leans is as breakable as the one clampable thing of Table I, and falls when it is touched.
        return AffordanceDescriptor(type="CLAMPABLE", material="mixed", fragility=FRAGILE_NEIGHBOUR, region="edge")
    material: Material = "glass" if transparent else "mixed"
    fragile = transparent or "stem" in regions
    return AffordanceDescriptor(
        type=kind, material=material, fragility=FRAGILE_GLASS if fragile else CAREFUL, region=region
    )


def _type_and_region(m: Measured, parts: dict[Region, Part], transparent: bool) -> tuple[AffordanceType, Region]:
    longer, shorter, height = (float(value) for value in m.box.size)
    if "stem" in parts:
        return "FRAGILE", "stem"
    if transparent:
        return "FRAGILE", "neck" if "neck" in parts else "body"
    if "handle" in parts:
        return ("GRASPABLE_HANDLE" if m.is_round else "TOOL_HANDLE"), "handle"
    if "rim" in parts and parts["rim"].width < THIN_WALL:
        return "GRASPABLE_EDGE", "rim"
    if max(shorter, height) < SMALL and longer < 0.10:
        return "PINCHABLE", "body"
    if longer > 3.0 * shorter and shorter < SLIM and height < SLIM:
        return "TOOL_HANDLE", "body"
    if height < FLAT and shorter > SLIM:
        return "CLAMPABLE", "edge"
    if m.is_ball or (m.is_round and height < 1.3 * longer):
        return "WRAPPABLE", "body"
    return "GRASPABLE_BODY", "body"
