"""Builds the scene graph G = (V, E) from a percept: 16 relations, every one verified by geometry (Sec. III-B; G5-G7).

Definitions (a R b), all in the world frame, from upright solids fitted to what was perceived:

ON_TOP_OF / SUPPORTS       footprints overlap, a's base within 1 cm of b's top; or a is inside b and sticks out of it
INSIDE / CONTAINS          b is hollow, a lies over it and begins at least 1 cm below its edge
OCCLUDES / OCCLUDED_BY     a hides at least a quarter of b from the front camera (where a's surface was seen)
BEHIND / IN_FRONT_OF       a is farther from the person at the front camera, within 60 degrees of the view
LEFT_OF / RIGHT_OF         a is to the person's left, within 60 degrees
ABOVE / BELOW              footprints overlap, a begins at b's top or higher
ADJACENT_TO                surface gap at most delta_check = 0.15 m
TOUCHING                   surface gap below 4 mm
LEANING_ON                 a is tilted, stands on the table, and its upper part touches b
BLOCKS_APPROACH            a is in at least 40 % of the hand's ways to b
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kb.base import Noun
from kb.by_identity import ByIdentity
from kb.errors import BadInputError
from kb.percept import PerceivedObject, Percept
from kb.scene_graph import SceneEdge, SceneGraph, SceneNode
from kb.vocabulary import INVERSE, RELATIONS, Relation
from tools.scene_relations.approach import blocks_approach
from tools.scene_relations.direction import is_behind, is_left_of
from tools.scene_relations.leaning import leans_on
from tools.scene_relations.line_of_sight import hides
from tools.scene_relations.solid import Solid, solid_of
from tools.scene_relations.support import is_above, is_inside, rests_on, sticks_out
from tools.scene_relations.surface_gap import surface_gap

if TYPE_CHECKING:
    import networkx as nx

    from tools.context import ToolContext

DELTA_CHECK = 0.15
"""Radius of neighbourhood delta_check [m] (Sec. III-B)."""
TOUCH = 0.004
"""Surface gap below which two things touch [m]: the spacing of measured surface points."""


class SceneGraphArgs(Noun):
    """Arguments of `build_scene_graph`."""

    percept: Percept
    target: str | None = None
    """Perceived id of the object to be grasped: BLOCKS_APPROACH is then worked out for it alone."""


def build_scene_graph(args: SceneGraphArgs, context: ToolContext) -> SceneGraph:
    """The scene graph of a percept; it does not depend on the order of the objects.

    The switch `distance` chooses how neighbourhood is measured: surface gap, or distance of centres (ledger G5).

    Raises:
        BadInputError: if the target is not among the objects.
    """
    ids = [obj.id for obj in args.percept.objects]
    if args.target is not None and args.target not in ids:
        raise BadInputError(f"there is no object {args.target!r} in the percept", choices=ids)
    by_centre = context.switches.distance == "centre"
    return _graphs.get(
        args.percept.objects, (args.target, by_centre), lambda: _scene_graph(args.percept, args.target, by_centre)
    )


KEPT = 32
"""Looks whose relations are kept: the configurations of a trial see the very same objects, and each target asks anew."""
_graphs: ByIdentity[SceneGraph] = ByIdentity(KEPT)
_pairs: ByIdentity[nx.MultiDiGraph[str]] = ByIdentity(KEPT)


def _scene_graph(percept: Percept, target: str | None, by_centre: bool) -> SceneGraph:
    graph = relation_graph(percept, target, by_centre=by_centre)
    nodes = tuple(graph.nodes[name]["node"] for name in sorted(graph.nodes))
    edges = [
        SceneEdge(source=source, relation=relation, target=target, gap=data["gap"])
        for source, target, relation, data in graph.edges(keys=True, data=True)
    ]
    return SceneGraph(nodes=nodes, edges=tuple(sorted(edges, key=_edge_order)))


def relation_graph(percept: Percept, target: str | None = None, *, by_centre: bool = False) -> nx.MultiDiGraph[str]:
    """The same as a networkx graph: nodes carry "node", edges are keyed by relation and carry "gap" [m]."""
    objects = sorted(percept.objects, key=lambda obj: obj.id)
    solids = {obj.id: solid_of(obj) for obj in objects}
    # What does not depend on the target is worked out once a look.
    between = _pairs.get(percept.objects, by_centre, lambda: _pair_graph(objects, solids, by_centre))
    graph = between.copy()
    for obj in objects:
        if target in (None, obj.id):
            _relate_approach(graph, obj, solids)
    return graph


def _pair_graph(objects: list[PerceivedObject], solids: dict[str, Solid], by_centre: bool) -> nx.MultiDiGraph[str]:
    """The relations of all pairs."""
    import networkx as nx

    graph: nx.MultiDiGraph[str] = nx.MultiDiGraph()
    for obj in objects:
        graph.add_node(obj.id, node=_node(obj))
    for i, one in enumerate(objects):
        for other in objects[i + 1 :]:
            between = surface_gap(solids[one.id], solids[other.id])
            gap = math.dist(one.position, other.position) if by_centre else between
            touching = between < TOUCH
            _relate_pair(graph, one, other, solids, gap, touching)
            _relate_pair(graph, other, one, solids, gap, touching)
    return graph


def _relate_pair(
    graph: nx.MultiDiGraph[str],
    one: PerceivedObject,
    other: PerceivedObject,
    solids: dict[str, Solid],
    gap: float,
    touching: bool,
) -> None:
    """Adds the relations one -> other that are stored, and the inverses other -> one that follow."""
    a, b = solids[one.id], solids[other.id]
    inside = is_inside(a, b, other)
    stacked = is_above(a, b) or is_above(b, a)
    directed = not (inside or stacked or is_inside(b, a, one))
    facts: dict[Relation, bool] = {
        "INSIDE": inside,
        "ON_TOP_OF": sticks_out(a, b) if inside else rests_on(a, b),
        "ABOVE": not inside and is_above(a, b),
        "OCCLUDES": directed and hides(a, b, one.surface_points()),
        "BEHIND": directed and is_behind(one.position, other.position),
        "LEFT_OF": directed and is_left_of(one.position, other.position),
        "ADJACENT_TO": gap <= DELTA_CHECK,
        "TOUCHING": touching,
        "LEANING_ON": directed and touching_or_near(gap) and leans_on(one, b),
    }
    for relation, holds in facts.items():
        if holds:
            graph.add_edge(one.id, other.id, key=relation, gap=gap)
            if relation in INVERSE:
                graph.add_edge(other.id, one.id, key=INVERSE[relation], gap=gap)


def touching_or_near(gap: float) -> bool:
    """A cheap gate for the leaning test: the boxes are within 2 cm."""
    return gap <= 0.02


def _relate_approach(graph: nx.MultiDiGraph[str], target: PerceivedObject, solids: dict[str, Solid]) -> None:
    centre = (target.position[0], target.position[1])
    for name, solid in solids.items():
        data = graph.get_edge_data(name, target.id) or {}
        if name == target.id or not data.keys().isdisjoint(("INSIDE", "CONTAINS", "BELOW")):
            continue
        if blocks_approach(solid, solids[target.id], centre):
            graph.add_edge(name, target.id, key="BLOCKS_APPROACH", gap=surface_gap(solid, solids[target.id]))


def _node(obj: PerceivedObject) -> SceneNode:
    return SceneNode(
        id=obj.id,
        category=obj.category,
        position=obj.position,
        state=obj.state,
        fragility=obj.affordance.fragility,
        size=obj.size,
        yaw=obj.yaw,
    )


def _edge_order(edge: SceneEdge) -> tuple[str, int, str]:
    return edge.source, RELATIONS.index(edge.relation), edge.target
