"""Laws of constraint inference for arbitrary arrangements of things."""

from __future__ import annotations

import math

from hypothesis import given, settings
from hypothesis import strategies as st

from kb.constraint import Constraints
from kb.percept import PerceivedObject
from kb.scene_graph import SceneGraph
from tests.percept_fixtures import SIZES, percept, thing
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.context import ToolContext
from tools.infer_constraints import ConstraintArgs, infer_constraints

places = st.tuples(
    st.sampled_from(sorted(SIZES)),
    st.floats(0.35, 0.65),
    st.floats(-0.2, 0.2),
    st.sampled_from([0.0, 0.0, 0.0, 0.05, 0.12]),
    st.sampled_from(["empty", "filled"]),
)
some = settings(max_examples=60, deadline=None)
ORDER = ["support", "occlusion", "content", "collision"]


@st.composite
def arrangements(draw: st.DrawFn) -> list[PerceivedObject]:
    rows = draw(st.lists(places, min_size=1, max_size=5))
    return [thing(f"o{i}", kind, x, y, base, state=state) for i, (kind, x, y, base, state) in enumerate(rows)]


def graph_of(objects: list[PerceivedObject]) -> SceneGraph:
    return build_scene_graph(SceneGraphArgs(percept=percept(*objects)), ToolContext())


def infer(graph: SceneGraph, margin: float = 1.0) -> Constraints:
    return infer_constraints(ConstraintArgs(graph=graph, target="o0", margin=margin), ToolContext())


@some
@given(arrangements())
def test_inference_is_deterministic_and_leaves_the_graph_alone(objects: list[PerceivedObject]) -> None:
    """Inferring twice from one graph gives the same, and the graph stays as it was."""
    graph = graph_of(objects)
    before = graph.model_dump_json()
    assert infer(graph) == infer(graph)
    assert graph.model_dump_json() == before


@some
@given(arrangements(), st.randoms(use_true_random=False))
def test_the_order_of_nodes_and_edges_does_not_matter(objects: list[PerceivedObject], rng: object) -> None:
    """The same constraints are active and the same adjustment comes out of a shuffled graph."""
    graph = graph_of(objects)
    nodes, edges = list(graph.nodes), list(graph.edges)
    rng.shuffle(nodes)  # type: ignore[attr-defined]
    rng.shuffle(edges)  # type: ignore[attr-defined]
    assert infer(SceneGraph(nodes=tuple(nodes), edges=tuple(edges))) == infer(graph)


@some
@given(arrangements())
def test_the_adjustment_follows_from_the_active_constraints(objects: list[PerceivedObject]) -> None:
    """Each field is changed exactly if its kind is active, by the paper's numbers, in the order of composition."""
    found = infer(graph_of(objects))
    kinds = [constraint.kind for constraint in found.active]
    change = found.adjustment
    assert kinds == sorted(kinds, key=ORDER.index)
    assert change.force_scale == (0.8 if "collision" in kinds else 1.0)
    assert change.standoff == (0.03 if "collision" in kinds else 0.0)
    assert change.speed == (0.3 if "content" in kinds else 1.0)
    assert change.direction == ((0.0, 0.0, -1.0) if "content" in kinds else None)
    assert (change.lateral is not None) == ("occlusion" in kinds)
    assert change.remove_first == tuple(c.target for c in found.active if c.kind == "support")
    assert math.hypot(*change.away) <= 0.3 * kinds.count("collision") + 1e-9
    if change.lateral is not None:
        assert abs(math.hypot(*change.lateral) - 1.0) < 1e-9
        assert change.lateral[2] == 0.0


@some
@given(arrangements(), st.floats(1.0, 1.5))
def test_wider_margins_never_drop_a_constraint(objects: list[PerceivedObject], margin: float) -> None:
    """What is active at margin 1 is active at any larger one."""
    graph = graph_of(objects)

    def active(found: Constraints) -> set[tuple[str, str]]:
        return {(constraint.kind, constraint.target) for constraint in found.active}

    assert active(infer(graph)) <= active(infer(graph, margin))


@some
@given(arrangements())
def test_no_constraint_concerns_a_thing_twice_or_one_that_is_removed(objects: list[PerceivedObject]) -> None:
    """Per kind each object stands once; removed objects are neither occluders nor neighbours; content is the target's."""
    found = infer(graph_of(objects))
    pairs = [(constraint.kind, constraint.target) for constraint in found.active]
    assert len(pairs) == len(set(pairs))
    removed = set(found.adjustment.remove_first)
    for kind, target in pairs:
        assert (target == "o0") == (kind == "content")
        if kind in ("occlusion", "collision"):
            assert target not in removed
