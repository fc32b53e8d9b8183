"""Infers the constraints of a target from the scene graph and composes their adjustment (Sec. III-B; ledger G5-G11).

Order of composition: support, occlusion, content, collision last, which overrides (ledger G11).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from kb.affordance import FRAGILE_NEIGHBOUR
from kb.base import Noun, Vec3
from kb.constraint import Adjustment, Constraint, Constraints
from kb.errors import BadInputError
from kb.scene_graph import SceneGraph, SceneNode

if TYPE_CHECKING:
    from tools.context import ToolContext

DELTA_SAFE = 0.10
"""Distance delta_safe below which a fragile neighbour matters [m] (Sec. III-B)."""
FORCE_SCALE = 0.8
"""Force next to a fragile neighbour (Sec. III-B); the planner floors it at the no-slip minimum (ledger G9)."""
STANDOFF = 0.03
"""Added to the pre-grasp stand-off next to a fragile neighbour [m] (Sec. III-B; ledger G10)."""
AWAY = 0.3
"""Length of the bias per fragile neighbour (ledger G11)."""
SLOW = 0.3
"""Velocity scale with contents (ledger G11)."""
MAX_TILT = math.radians(15.0)
"""Largest tilt of the approach with contents [rad] (ledger G11)."""
DOWN: Vec3 = (0.0, 0.0, -1.0)


class ConstraintArgs(Noun):
    """Arguments of `infer_constraints`."""

    graph: SceneGraph
    target: str
    """Perceived id of the object to be grasped."""
    margin: Annotated[float, Field(ge=1.0, le=3.0)] = 1.0
    """Scale of delta_safe; 1.5 after a constraint violation (ledger G18)."""


def infer_constraints(args: ConstraintArgs, context: ToolContext) -> Constraints:
    """The constraints that the scene puts on grasping the target, and their composed adjustment.

    The switch `away` chooses the reading of "biases the approach away" (ledger G11).

    Raises:
        BadInputError: if the target is not in the graph.
    """
    nodes = {node.id: node for node in args.graph.nodes}
    if args.target not in nodes:
        raise BadInputError(f"there is no object {args.target!r} in the scene graph", choices=sorted(nodes))
    target = nodes[args.target]
    graph = _canonical(args.graph)
    removed = supported_by(graph, target.id)
    support = [_support(nodes[name], target, graph) for name in removed]
    occlusion = _occlusion(graph, target, nodes, removed)
    content = _content(graph, target, nodes, removed)
    collision = _collision(graph, target, nodes, removed, args.margin)
    adjustment = Adjustment(remove_first=removed, margin=args.margin)
    if occlusion:
        lateral = _lateral(target, [nodes[c.target] for c in occlusion], graph.nodes)
        adjustment = adjustment.model_copy(update={"lateral": lateral})
    if content:
        adjustment = adjustment.model_copy(update={"direction": DOWN, "speed": SLOW, "max_tilt": MAX_TILT})
    if collision:
        sign = 1.0 if context.switches.away == "hand_side" else -1.0
        neighbours = [nodes[c.target] for c in collision]
        adjustment = adjustment.model_copy(update=_keep_clear(target, neighbours, sign))
    return Constraints(active=(*support, *occlusion, *content, *collision), adjustment=adjustment)


def _canonical(graph: SceneGraph) -> SceneGraph:
    """The same graph in one order, so that sums of floats do not depend on who listed it."""
    nodes = sorted(graph.nodes, key=lambda node: node.id)
    edges = sorted(graph.edges, key=lambda edge: (edge.source, edge.relation, edge.target))
    return SceneGraph(nodes=tuple(nodes), edges=tuple(edges))


def supported_by(graph: SceneGraph, target: str) -> tuple[str, ...]:
    """Everything that rests on the target, directly or not, topmost first (ledger G7); ties by id."""
    import networkx as nx

    tree: nx.DiGraph[str] = nx.DiGraph()
    tree.add_node(target)
    tree.add_edges_from((e.source, e.target) for e in graph.edges if e.relation == "SUPPORTS")
    above: set[str] = nx.descendants(tree, target) - {target}  # pyright: ignore[reportUnknownMemberType]
    height = {node.id: node.position[2] - node.size[2] / 2.0 for node in graph.nodes}
    return tuple(sorted(above, key=lambda name: (-height[name], name)))


def _support(upper: SceneNode, target: SceneNode, graph: SceneGraph) -> Constraint:
    direct = any(e.target == upper.id for e in graph.edges_from(target.id, "SUPPORTS"))
    how = "rests on" if direct else "rests on something on"
    return Constraint(
        kind="support",
        target=upper.id,
        reason=f"the {_name(upper)} {how} the {_name(target)}: it is removed first",
        gap=0.0,
    )


def _content(
    graph: SceneGraph, target: SceneNode, nodes: dict[str, SceneNode], removed: tuple[str, ...]
) -> list[Constraint]:
    """A filled target, or one with things inside that stay in it, is kept upright and moved slowly."""
    inside = [nodes[e.target] for e in graph.edges_from(target.id, "CONTAINS") if e.target not in removed]
    if target.state != "filled" and not inside:
        return []
    what = "is filled" if target.state == "filled" else f"contains the {_name(inside[0])}"
    reason = f"the {_name(target)} {what}: approach straight down, at {SLOW:g} of full speed"
    return [Constraint(kind="content", target=target.id, reason=reason)]


def _occlusion(
    graph: SceneGraph, target: SceneNode, nodes: dict[str, SceneNode], removed: tuple[str, ...]
) -> list[Constraint]:
    found: list[Constraint] = []
    for edge in graph.edges_from(target.id, "OCCLUDED_BY"):
        if edge.target in removed:
            continue
        occluder = nodes[edge.target]
        reason = f"the {_name(occluder)} stands in the line of sight to the {_name(target)}: pass it laterally"
        found.append(Constraint(kind="occlusion", target=occluder.id, reason=reason, gap=edge.gap))
    return found


def _collision(
    graph: SceneGraph, target: SceneNode, nodes: dict[str, SceneNode], removed: tuple[str, ...], margin: float
) -> list[Constraint]:
    found: list[Constraint] = []
    carried = {*removed, *(edge.target for edge in graph.edges_from(target.id, "CONTAINS"))}
    for edge in graph.edges_from(target.id, "ADJACENT_TO"):
        neighbour = nodes[edge.target]
        if edge.gap is None or edge.gap > DELTA_SAFE * margin or edge.target in carried:
            continue
        if neighbour.fragility < FRAGILE_NEIGHBOUR:
            continue
        reason = (
            f"the {_name(neighbour)} (fragility {neighbour.fragility:.2g}) is {edge.gap * 100:.1f} cm from the "
            f"{_name(target)}: less force, higher start, hand away from it"
        )
        found.append(Constraint(kind="collision", target=neighbour.id, reason=reason, gap=edge.gap))
    return found


def _keep_clear(target: SceneNode, neighbours: list[SceneNode], sign: float) -> dict[str, object]:
    """Changes of the adjustment for fragile neighbours; force and stand-off change once, not per neighbour."""
    units = [_towards(target.position, neighbour.position) for neighbour in neighbours]
    away = (sign * AWAY * sum(u[0] for u in units), sign * AWAY * sum(u[1] for u in units), 0.0)
    return {
        "away": away,
        "avoid_yaw": tuple(math.atan2(u[1], u[0]) for u in units if u != (0.0, 0.0)),
        "force_scale": FORCE_SCALE,
        "standoff": STANDOFF,
    }


def _lateral(target: SceneNode, occluders: list[SceneNode], nodes: tuple[SceneNode, ...]) -> Vec3:
    """Horizontal unit vector across the line target -> occluders, to the side with more room; ties: towards y = 0.

    Room is the distance to the nearest other object's centre from a point 0.10 m aside of the target.
    """
    x = sum(_towards(target.position, o.position)[0] for o in occluders)
    y = sum(_towards(target.position, o.position)[1] for o in occluders)
    length = math.hypot(x, y)
    across = (-y / length, x / length) if length > 1e-9 else (0.0, 1.0)
    others = [node for node in nodes if node.id != target.id and node.id not in {o.id for o in occluders}]

    def room(sign: float) -> tuple[float, float]:
        px = target.position[0] + sign * 0.10 * across[0]
        py = target.position[1] + sign * 0.10 * across[1]
        nearest = min((math.hypot(px - o.position[0], py - o.position[1]) for o in others), default=1.0)
        return min(nearest, 0.25), -abs(py)

    sign = 1.0 if room(1.0) >= room(-1.0) else -1.0
    return (sign * across[0], sign * across[1], 0.0)


def _towards(start: Vec3, end: Vec3) -> tuple[float, float]:
    """Horizontal unit vector start -> end; null if they coincide."""
    x, y = end[0] - start[0], end[1] - start[1]
    length = math.hypot(x, y)
    return (x / length, y / length) if length > 1e-9 else (0.0, 0.0)


def _name(node: SceneNode) -> str:
    return node.category.replace("_", " ") if node.category != "unknown" else f"unknown thing {node.id}"
