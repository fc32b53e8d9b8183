"""The scene-graph report: its truth is independent of the solids, and its counting is right."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from bench.scene_graph_report import KINDS, Comparison, compare, run_scene, summarise
from bench.true_relations import TrueThing, hidden_share, true_graph
from kb.percept import Percept
from kb.priors import prior
from kb.vocabulary import RELATIONS
from tests.percept_fixtures import percept, thing


def ball(name: str, x: float, y: float, radius: float = 0.04) -> TrueThing:
    """A sphere that stands on the table, evenly sampled."""
    steps = np.arange(3000) + 0.5
    height, turn = 1.0 - 2.0 * steps / 3000, steps * np.pi * (1.0 + 5.0**0.5)
    ring = np.sqrt(1.0 - height**2)
    unit = np.column_stack([ring * np.cos(turn), ring * np.sin(turn), height])
    return TrueThing(
        id=name,
        category="apple",
        surface=unit * radius + np.array([x, y, radius]),
        affordance=prior("apple").affordance,
        state="empty",
        hollow=False,
        tilt=0.0,
    )


def perceived(*things: TrueThing) -> Percept:
    return percept(*(thing(t.id, "apple", t.centre[0], t.centre[1]) for t in things))


def test_true_gaps_are_those_of_spheres() -> None:
    """Two balls of radius 4 cm whose centres are 12 cm apart have a gap of 4 cm, within the spacing of the samples."""
    edges = true_graph([ball("a", 0.5, 0.0), ball("b", 0.5, 0.12)]).edges
    gaps = {edge.relation: edge.gap for edge in edges}
    assert gaps["ADJACENT_TO"] == pytest.approx(0.04, abs=1e-3)
    assert "TOUCHING" not in gaps


def test_a_ball_right_in_front_hides_a_smaller_one() -> None:
    """Seen along the camera's bearing the larger ball hides a good part of the one behind, not the other way round."""
    front, back = ball("f", 0.61, 0.0, radius=0.06), ball("b", 0.51, 0.0)
    assert hidden_share(front, back) > 0.3
    assert hidden_share(back, front) < 0.05
    assert hidden_share(ball("s", 0.60, 0.15), back) == 0.0


def test_a_perfect_percept_has_no_mistakes() -> None:
    """Balls reported where they are give precision and recall 1, and each relation is counted as often as it is true."""
    things = [ball("a", 0.5, 0.0), ball("b", 0.5, 0.12), ball("c", 0.63, 0.0)]
    summary = summarise([compare(0, "balls", perceived(*things), things)])
    assert summary["all_edges"]["precision"] == summary["all_edges"]["recall"] == 1.0
    assert summary["all_edges"]["true"] == len(true_graph(things).edges)


def test_missed_and_made_up_objects_count_with_all_their_edges() -> None:
    """A missed ball costs recall, an invented one precision; edges between found objects are judged apart."""
    things = [ball("a", 0.5, 0.0), ball("b", 0.5, 0.12), ball("c", 0.63, 0.0)]
    fewer = compare(0, "missed", perceived(*things[:2]), things)
    assert fewer.edges["ADJACENT_TO", "missed"] == 4
    more = compare(0, "made up", percept(*(perceived(*things).objects), thing("x", "cube", 0.4, -0.1)), things)
    assert more.edges["LEFT_OF", "false"] > 0
    for result in (fewer, more):
        assert {outcome for (_, outcome), count in result.found_edges.items() if count} == {"hit"}


@pytest.mark.slow
def test_with_true_percepts_the_graph_is_nearly_the_truth() -> None:
    """One scene of each kind, perceived by the oracle: at least 95 % precision and recall over all edges."""
    results = [run_scene((10000 + i, "oracle")) for i in range(len(KINDS))]
    summary = summarise(results)
    assert summary["all_edges"]["precision"] >= 0.95
    assert summary["all_edges"]["recall"] >= 0.95
    assert summary["all_edges"]["true"] > 50


def test_the_sum_over_scenes_adds_counts() -> None:
    """Two scenes with one hit and one miss of a relation: recall one half, and every relation has a row."""
    scenes = [
        Comparison(0, "a", edges=Counter({("TOUCHING", "hit"): 1})),
        Comparison(1, "b", edges=Counter({("TOUCHING", "missed"): 1})),
    ]
    summary = summarise(scenes)
    assert summary["relations"]["TOUCHING"] == {"true": 2, "precision": 1.0, "recall": 0.5}
    assert set(summary["relations"]) == set(RELATIONS)
