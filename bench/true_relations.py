"""The 16 relations from the simulator's truth, computed from dense samples of the true surfaces.

Same definitions as `tools.build_scene_graph`, other geometry: no fitted solids but points, nearest neighbours, convex
hulls and a rasterised view. So an error of the solids shows up as an error of the graph.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kb.affordance import AffordanceDescriptor
from kb.scene_graph import SceneEdge, SceneGraph, SceneNode
from kb.viewpoint import EYE
from kb.vocabulary import INVERSE, ObjectState, Relation
from tools.build_scene_graph import DELTA_CHECK, TOUCH
from tools.perception.upright_box import box_at, smallest_yaw
from tools.scene_relations import approach
from tools.scene_relations.direction import is_behind, is_left_of
from tools.scene_relations.leaning import STANDING, TILT
from tools.scene_relations.line_of_sight import HIDDEN_SHARE
from tools.scene_relations.support import INSIDE_DEPTH, INSIDE_OVERLAP, OVERLAP, REST_TOLERANCE

Array = NDArray[np.float64]

CELL = 0.004
"""Cell of the rasterised view, as an angle [rad]: about 4 mm on the table."""


@dataclass(frozen=True)
class TrueThing:
    """What the truth says about one object."""

    id: str
    category: str
    surface: Array
    """Samples of the surface in the world frame (N, 3) [m]."""
    affordance: AffordanceDescriptor
    state: ObjectState
    hollow: bool
    """It is open and wide enough to hold things."""
    tilt: float
    """Angle between its own vertical and the world's [rad]."""

    @property
    def low(self) -> float:
        return float(self.surface[:, 2].min())

    @property
    def high(self) -> float:
        return float(self.surface[:, 2].max())

    @cached_property
    def centre(self) -> tuple[float, float, float]:
        """Centre of the smallest upright box, which is what a percept calls position [m]."""
        middle = box_at(self.surface, smallest_yaw(self.surface)[0]).centre
        return float(middle[0]), float(middle[1]), float(middle[2])

    @cached_property
    def hull(self) -> Array:
        """Sides of the footprint's convex hull (K, 3): outward normal and offset, negative inside."""
        from scipy.spatial import ConvexHull

        return np.asarray(ConvexHull(self.surface[:, :2]).equations)

    @cached_property
    def view(self) -> dict[tuple[int, int], float]:
        """Cells of the view from the front camera that the samples fall into, with the nearest distance in each [m]."""
        along = self.surface - np.asarray(EYE)
        distance = np.linalg.norm(along, axis=1)
        bearing = np.arctan2(along[:, 1], -along[:, 0])
        dip = np.arcsin(along[:, 2] / distance)
        cells: dict[tuple[int, int], float] = {}
        columns, rows = np.floor(bearing / CELL).astype(int).tolist(), np.floor(dip / CELL).astype(int).tolist()
        for key, d in zip(zip(columns, rows, strict=True), distance.tolist(), strict=True):
            cells[key] = min(cells.get(key, math.inf), d)
        return cells

    @cached_property
    def breadth(self) -> float:
        """Smallest extent over all horizontal directions [m]."""
        angles = np.linspace(0.0, math.pi, 36, endpoint=False)
        along = self.surface[:, :2] @ np.stack([np.cos(angles), np.sin(angles)])
        return float(np.ptp(along, axis=0).min())


def true_graph(things: list[TrueThing]) -> SceneGraph:
    """The scene graph of the truth; node ids are the scene's."""
    edges: dict[tuple[str, Relation, str], float] = {}
    for i, one in enumerate(things):
        for other in things[i + 1 :]:
            gap = _gap(one, other)
            for a, b in ((one, other), (other, one)):
                for relation in _relations(a, b, gap):
                    edges[a.id, relation, b.id] = gap
                    if relation in INVERSE:
                        edges[b.id, INVERSE[relation], a.id] = gap
    nodes = tuple(_node(thing) for thing in sorted(things, key=lambda thing: thing.id))
    listed = [SceneEdge(source=a, relation=r, target=b, gap=gap) for (a, r, b), gap in sorted(edges.items())]
    return SceneGraph(nodes=nodes, edges=tuple(listed))


def _relations(a: TrueThing, b: TrueThing, gap: float) -> list[Relation]:
    inside, above = _inside(a, b), _above(a, b)
    apart = not (inside or above or _inside(b, a) or _above(b, a))
    sunk = inside and a.high >= b.high + INSIDE_DEPTH
    facts: dict[Relation, bool] = {
        "INSIDE": inside,
        "ON_TOP_OF": sunk or (above and not inside and a.low <= b.high + REST_TOLERANCE),
        "ABOVE": above and not inside,
        "OCCLUDES": apart and hidden_share(a, b) >= HIDDEN_SHARE,
        "BEHIND": apart and is_behind(a.centre, b.centre),
        "LEFT_OF": apart and is_left_of(a.centre, b.centre),
        "ADJACENT_TO": gap <= DELTA_CHECK,
        "TOUCHING": gap < TOUCH,
        "LEANING_ON": apart and gap < TOUCH and TILT[0] <= a.tilt <= TILT[1] and a.low <= STANDING,
        "BLOCKS_APPROACH": not (inside or _inside(b, a) or _above(b, a))
        and blocked_share(a, b) >= approach.BLOCKED_SHARE,
    }
    return [relation for relation, holds in facts.items() if holds]


def _gap(one: TrueThing, other: TrueThing) -> float:
    """Distance of the surfaces [m]: nearest samples, whose spacing makes it up to 2 mm too large at contact."""
    from scipy.spatial import KDTree

    return float(KDTree(one.surface).query(other.surface)[0].min())


def _share_over(one: TrueThing, other: TrueThing) -> float:
    """Share of the surface samples of `one` over the convex hull of the other's footprint."""
    lower, upper = other.surface[:, :2].min(axis=0), other.surface[:, :2].max(axis=0)
    near = one.surface[np.all((one.surface[:, :2] >= lower) & (one.surface[:, :2] <= upper), axis=1), :2]
    if not len(near):
        return 0.0
    normals, offsets = other.hull[:, :2], other.hull[:, 2]
    return float((near @ normals.T + offsets <= 1e-9).all(axis=1).sum() / len(one.surface))


def _above(upper: TrueThing, lower: TrueThing) -> bool:
    tolerance = min(REST_TOLERANCE, (lower.high - lower.low) / 2.0)
    if upper.centre[2] <= lower.centre[2] or upper.low < lower.high - tolerance:
        return False
    return max(_share_over(upper, lower), _share_over(lower, upper)) >= OVERLAP


def _inside(inner: TrueThing, outer: TrueThing) -> bool:
    return (
        outer.hollow
        and inner.breadth < outer.breadth
        and outer.low - REST_TOLERANCE <= inner.low <= outer.high - INSIDE_DEPTH
        and _share_over(inner, outer) >= INSIDE_OVERLAP
    )


def hidden_share(front: TrueThing, back: TrueThing) -> float:
    """Share of the cells of the back thing's silhouette, seen from the front camera, where the front thing is nearer."""
    nearer = front.view
    return float(np.mean([nearer.get(cell, math.inf) < mine for cell, mine in back.view.items()]))


def blocked_share(obstacle: TrueThing, target: TrueThing) -> float:
    """Share of the hand's ways to the target in whose swept boxes a surface sample of the obstacle lies."""
    x, y, _ = target.centre
    ways = [_from_above(obstacle.surface, target, math.pi * i / approach.YAWS) for i in range(approach.YAWS)]
    if target.high - target.low >= approach.SIDE_HEIGHT:
        ways += [_from_side(obstacle.surface, target, math.atan2(y, x) + turn) for turn in approach.HEADINGS]
    return sum(ways) / len(ways)


def _from_above(points: Array, target: TrueThing, yaw: float) -> bool:
    u, v = _turned(points, target, yaw)
    tip = max(target.low + 0.005, target.high - 0.030)
    fingers = (abs(u) <= approach.FINGER_HALF_ALONG) & (abs(v) <= approach.FINGER_HALF_ACROSS) & (points[:, 2] >= tip)
    palm = (abs(u) <= approach.PALM_HALF_ALONG) & (abs(v) <= approach.PALM_HALF_ACROSS)
    return bool((fingers | (palm & (points[:, 2] >= tip + approach.FINGER))).any())


def _from_side(points: Array, target: TrueThing, heading: float) -> bool:
    u, v = _turned(points, target, heading)
    height = max(0.04, (target.low + target.high) / 2.0)
    back = approach.FINGER + approach.PALM_THICK + approach.STANDOFF
    swept = (u <= -approach.FINGER) & (u >= -back) & (abs(v) <= approach.PALM_HALF_ALONG)
    return bool((swept & (abs(points[:, 2] - height) <= approach.PALM_HALF_ACROSS)).any())


def _turned(points: Array, target: TrueThing, yaw: float) -> tuple[Array, Array]:
    """Plane coordinates of points (N, 3) along and across `yaw`, from the target's centre."""
    x, y = points[:, 0] - target.centre[0], points[:, 1] - target.centre[1]
    return x * math.cos(yaw) + y * math.sin(yaw), y * math.cos(yaw) - x * math.sin(yaw)


def _node(thing: TrueThing) -> SceneNode:
    size = np.ptp(thing.surface, axis=0)
    return SceneNode(
        id=thing.id,
        category=thing.category,
        position=thing.centre,
        state=thing.state,
        fragility=thing.affordance.fragility,
        size=(float(size[0]), float(size[1]), float(size[2])),
        yaw=0.0,
    )
