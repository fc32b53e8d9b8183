"""Laws of the scene graph for arbitrary arrangements of things."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from kb.percept import PerceivedObject
from kb.scene_graph import SceneGraph
from kb.vocabulary import INVERSE
from tests.percept_fixtures import SIZES, percept, thing
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.context import ToolContext
from tools.scene_relations.solid import solid_of
from tools.scene_relations.surface_gap import surface_gap

places = st.tuples(
    st.sampled_from(sorted(SIZES)),
    st.floats(0.3, 0.8),
    st.floats(-0.35, 0.35),
    st.sampled_from([0.0, 0.0, 0.05, 0.12]),
    st.floats(-1.5, 1.5),
)


@st.composite
def arrangements(draw: st.DrawFn, least: int = 1, most: int = 5) -> list[PerceivedObject]:
    rows = draw(st.lists(places, min_size=least, max_size=most))
    return [thing(f"o{i}", kind, x, y, base, yaw=yaw) for i, (kind, x, y, base, yaw) in enumerate(rows)]


some = settings(max_examples=60, deadline=None)


def graph_of(objects: list[PerceivedObject]) -> SceneGraph:
    return build_scene_graph(SceneGraphArgs(percept=percept(*objects)), ToolContext())


@some
@given(arrangements(), st.randoms(use_true_random=False))
def test_the_order_of_the_objects_does_not_matter(objects: list[PerceivedObject], rng: object) -> None:
    """Shuffling the percept leaves the graph unchanged."""
    shuffled = list(objects)
    rng.shuffle(shuffled)  # type: ignore[attr-defined]
    assert graph_of(objects) == graph_of(shuffled)


@some
@given(arrangements())
def test_every_inverse_is_there_and_nothing_relates_to_itself(objects: list[PerceivedObject]) -> None:
    """A R b exactly if b R' a, for the 14 relations that have an inverse; no loops, no edge twice."""
    edges = graph_of(objects).edges
    triples = {(edge.source, edge.relation, edge.target) for edge in edges}
    assert len(triples) == len(edges)
    for source, relation, target in triples:
        assert source != target
        if relation in INVERSE:
            assert (target, INVERSE[relation], source) in triples


@some
@given(arrangements())
def test_relations_that_exclude_each_other_never_meet(objects: list[PerceivedObject]) -> None:
    """No pair is ABOVE and BELOW, LEFT_OF and RIGHT_OF, BEHIND and IN_FRONT_OF, and support has no circle of two."""
    triples = {(edge.source, edge.relation, edge.target) for edge in graph_of(objects).edges}
    for source, relation, target in triples:
        if relation in ("ABOVE", "LEFT_OF", "BEHIND", "ON_TOP_OF", "INSIDE"):
            assert (target, relation, source) not in triples
        if relation == "TOUCHING":
            assert (source, "ADJACENT_TO", target) in triples


@some
@given(arrangements(2, 2), st.floats(-math.pi, math.pi), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_the_gap_is_symmetric_and_moves_with_the_pair(
    pair: list[PerceivedObject], turn: float, dx: float, dy: float
) -> None:
    """gap(a, b) = gap(b, a) >= 0, unchanged when both are turned and shifted together on the table."""

    def moved(obj: PerceivedObject) -> PerceivedObject:
        x, y, z = obj.position
        c, s = math.cos(turn), math.sin(turn)
        place = (c * x - s * y + dx, s * x + c * y + dy, z)
        return obj.model_copy(update={"position": place, "yaw": obj.yaw + turn})

    one, other = solid_of(pair[0]), solid_of(pair[1])
    gap = surface_gap(one, other)
    assert abs(gap - surface_gap(other, one)) < 1e-12
    assert gap >= 0.0
    again = surface_gap(solid_of(moved(pair[0])), solid_of(moved(pair[1])))
    assert abs(again - gap) < 1e-9


@some
@given(arrangements(2, 2), st.integers(0, 2**32 - 1))
def test_the_gap_is_never_more_than_the_distance_of_two_surface_points(pair: list[PerceivedObject], seed: int) -> None:
    """Sampled points of both solids are at least the gap apart, and each is at least the gap from the other solid."""
    rng = np.random.default_rng(seed)
    one, other = solid_of(pair[0]), solid_of(pair[1])
    gap = surface_gap(one, other)
    for first, second in ((one, other), (other, one)):
        box = rng.uniform([0.1, -0.6, 0.0], [1.0, 0.6, 0.4], (4000, 3))
        inside = box[first.distance(box) == 0.0]
        assume(len(inside) > 0)
        assert second.distance(inside).min() >= gap - 1e-9


@some
@given(arrangements(2, 2))
def test_a_translation_away_never_brings_things_closer(pair: list[PerceivedObject]) -> None:
    """Moving the second thing outwards along the line of centres does not shrink the gap of convex solids."""
    (ax, ay, _), (bx, by, bz) = pair[0].position, pair[1].position
    length = math.hypot(bx - ax, by - ay)
    assume(length > 1e-3)
    farther = pair[1].model_copy(
        update={"position": (bx + 0.1 * (bx - ax) / length, by + 0.1 * (by - ay) / length, bz)}
    )
    before = surface_gap(solid_of(pair[0]), solid_of(pair[1]))
    assert surface_gap(solid_of(pair[0]), solid_of(farther)) >= before - 1e-9
