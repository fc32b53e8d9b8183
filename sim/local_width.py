"""True width of an object between the fingers, and true distance from a region: geometry of the placed truth."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from kb.percept import Part
from sim.placed import PlacedObject

Array = NDArray[np.float64]

PAD_HALF = (-0.0085, -0.004, 0.0, 0.004, 0.0085)
"""Offsets of the probing lines over a pad, across and along the fingers [m] (a pad measures about 18 x 18 mm)."""
_ACROSS, _ALONG = (grid.reshape(-1, 1) for grid in np.meshgrid(PAD_HALF, PAD_HALF, indexing="ij"))
FAR = 0.5
"""Probing lines start this far from the tool point [m]."""
RIM_DEPTH = 0.03
"""A wall may be gripped up to this far below its edge [m]."""


def local_width(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    geoms: Sequence[int],
    position: ArrayLike,
    rotation: Array,
    opening: float,
) -> float:
    """Width of what lies between the open fingers, along the closing axis [m]; 0 if nothing does.

    Lines along the closing axis are cut with every convex piece; pieces that begin between the pads count with their
    full extent, also where it reaches beyond a pad: then the object does not fit.

    Args:
        model: Compiled scene.
        data: Its state, with positions of the geoms up to date.
        geoms: Geom ids of the object.
        position: Tool point in the world [m], (3,).
        rotation: Hand-to-world rotation (3, 3), columns across, closing axis, approach.
        opening: Distance between the pads [m].
    """
    low, high = np.inf, -np.inf
    near = near_pads(model, data, geoms, np.asarray(position, float), opening)
    geoms = [geom for geom, keep in zip(geoms, near, strict=True) if keep]
    if not geoms:
        return 0.0
    axis = np.ascontiguousarray(rotation[:, 1])
    middles = np.asarray(position, float) + _ACROSS * rotation[:, 0] + _ALONG * rotation[:, 2]
    cuts = [_cut_of(model, data, geom) for geom in geoms]
    back, befores, beyonds = -axis, middles - FAR * axis, middles + FAR * axis
    for before, beyond, near in zip(befores, beyonds, _met(model, data, geoms, middles, axis), strict=True):
        for cut in itertools.compress(cuts, near):
            ahead = cut(before, axis)
            if ahead >= 0:
                start, end = ahead - FAR, FAR - cut(beyond, back)
                if start < opening / 2 and end > -opening / 2:
                    low, high = min(low, start), max(high, end)
    return float(max(0.0, high - low)) if high > low else 0.0


def near_pads(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int], position: Array, opening: float
) -> list[bool]:
    """Which geoms' bounding spheres come between the pads; the others cannot lie there."""
    reach = np.hypot(opening / 2, np.hypot(PAD_HALF[-1], PAD_HALF[-1])) + 1e-6
    radii = model.geom_rbound[list(geoms)]
    away = np.linalg.norm(data.geom_xpos[list(geoms)] - position, axis=1)
    return ((radii <= 0.0) | (away <= radii + reach)).tolist()


def _met(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int], middles: Array, axis: Array
) -> list[list[bool]]:
    """For each line (L, 3) along `axis` which geoms' bounding spheres it meets; it misses all others."""
    radii = model.geom_rbound[list(geoms)]
    offset = data.geom_xpos[list(geoms)] - middles[:, None]
    along = offset @ axis
    beside = np.einsum("lgi,lgi->lg", offset, offset) - along * along
    return ((radii <= 0.0) | (beside <= (radii + 1e-6) ** 2)).tolist()


MESH = int(mujoco.mjtGeom.mjGEOM_MESH)


def _cut_of(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Callable[[Array, Array], float]:
    """What tells where a line from a point along a direction first meets a geom [m]; negative if it misses it.

    A geom is cut with dozens of lines, so it is looked up once.
    """
    kind = int(model.geom_type[geom])
    if kind == MESH:
        return lambda start, direction: mujoco.mj_rayMesh(model, data, geom, start, direction)
    place, turn, size = data.geom_xpos[geom], data.geom_xmat[geom], model.geom_size[geom]
    return lambda start, direction: mujoco.mju_rayGeom(place, turn, size, start, direction, kind)


def region_distance(thing: PlacedObject, point: ArrayLike, region: str | None = None) -> float:
    """Distance e_p [m] from a point of the object's frame to the nearest graspable point of a region (ledger G15).

    Args:
        thing: The object.
        point: In the object's frame (3,) [m].
        region: The affordance's own region if None. An object without such a part is graspable along its middle.
    """
    wanted = thing.affordance.region if region is None else region
    parts = [part for part in thing.parts if part.region == wanted]
    if not parts:
        offset = np.asarray(point, float) - np.array([0.0, 0.0, thing.size[2] / 2])
        return float(np.linalg.norm(np.maximum(np.abs(offset) - np.asarray(thing.size) / 2, 0.0)))
    return min(distance_to_part(part, point) for part in parts)


def distance_to_part(part: Part, point: ArrayLike) -> float:
    """Distance of a point to where the pads' middle may be on a part [m]: its axis, or for a rim its wall."""
    axis = np.asarray(part.axis, float) / np.linalg.norm(part.axis)
    offset = np.asarray(point, float) - np.asarray(part.centre, float)
    along = float(offset @ axis)
    radial = float(np.linalg.norm(offset - along * axis))
    if part.region == "rim" and part.radius is not None:
        below = max(0.0, along, -along - RIM_DEPTH)
        return float(np.hypot(radial - part.radius, below))
    beyond = max(0.0, abs(along) - part.length / 2)
    return float(np.hypot(radial, beyond))
