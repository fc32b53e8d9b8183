"""Bounds of many candidates at once are what the formulas give for each of them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kb.experience import Strategy
from kb.percept import PerceivedObject
from kb.sensing import Correction
from sim.quality import Load
from tests.planning_fixtures import bottle, cup, experience, screwdriver
from tools.planning.constrain_candidates import Constrained
from tools.planning.force_choice import force_terms
from tools.planning.generate_candidates import generate_candidates
from tools.planning.grasp_prior import affordance_prior, from_strategy
from tools.planning.rank_candidates import ROOMY, total_score
from tools.planning.score_bounds import score_bounds
from tools.planning.shape_grasp import first_opening

WIDER = Correction(failure="WIDTH_MISMATCH", level=1, rule="wider", changes={"aperture": 0.07})


@pytest.mark.parametrize("gentle", [None, 3.0])
@pytest.mark.parametrize("correction", [None, WIDER])
@pytest.mark.parametrize("seen", [cup("t", 0.5, 0.1), bottle("t", 0.45, -0.1), screwdriver("t", 0.5, 0.0, 0.7)])
def test_all_at_once_is_each_by_itself(
    seen: PerceivedObject, correction: Correction | None, gentle: float | None
) -> None:
    """Bit for bit the score with full clearance, with and without experience, correction, malus and what failed before."""
    strategy: Strategy = experience("e", seen).strategy
    pool = [Constrained(candidate, 0.01 * (k % 3)) for k, candidate in enumerate(generate_candidates(seen))]
    for prior in (affordance_prior(seen), from_strategy(strategy, "experience", "e", 0.2)):
        for avoid in ((), (strategy,)):
            force = replace(force_terms(seen, prior, scale=0.8, scale_reason="neighbour"), gentle=gentle)
            load = Load.of(force.mass, force.friction, seen.affordance.fragility, seen.affordance.type)
            each: list[float] = []
            for item in pool:
                candidate, opening = item.candidate, first_opening(item.candidate, correction)
                q, _ = load.grade(
                    opening, force.force(candidate), candidate.type, candidate.miss, candidate.width, ROOMY
                )
                each.append(total_score(q, item, prior, avoid, ROOMY))
            assert score_bounds(pool, prior, force, load, avoid, correction).tolist() == each
