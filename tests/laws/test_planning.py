"""Laws that every plan obeys, whatever stands where."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kb.constraint import Adjustment, Constraints
from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE
from kb.percept import PerceivedObject
from kb.sensing import Plan
from sim.quality import maximum_force
from sim.swept_hand import swept_clearance
from tests.planning_fixtures import bottle, context, cup, percept, screwdriver, solid
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.planning.generate_candidates import generate_candidates

QUICK = settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow])
PLACES = st.tuples(st.floats(0.40, 0.62), st.floats(-0.22, 0.22), st.floats(-math.pi, math.pi))
KINDS = st.sampled_from(["cup", "apple", "bottle", "bowl", "cube", "smartphone", "screwdriver", "tennis_ball", "block"])


def thing(kind: str, object_id: str, x: float, y: float, yaw: float) -> PerceivedObject:
    if kind == "cup":
        return cup(object_id, x, y, yaw)
    if kind == "bottle":
        return bottle(object_id, x, y)
    if kind == "screwdriver":
        return screwdriver(object_id, x, y, math.remainder(yaw, math.pi))
    return solid(object_id, kind, x, y, math.remainder(yaw, math.pi))


def plan_of(*objects: PerceivedObject, constraints: Constraints | None = None) -> Plan | None:
    args = PlanArgs(percept=percept(*objects), target="t", constraints=constraints or Constraints())
    return plan_grasp(args, context()).plan


@QUICK
@given(kind=KINDS, place=PLACES)
def test_a_plan_stays_within_hand_table_and_object(kind: str, place: tuple[float, float, float]) -> None:
    """Opening and force within the hand's, force below what the object bears, tips above the table, opening > width."""
    seen = thing(kind, "t", *place)
    plan = plan_of(seen)
    if plan is None:
        return
    grasp = plan.grasp
    assert plan.local_width <= grasp.aperture + 0.0005 or plan.local_width > MAX_APERTURE
    assert MIN_FORCE <= grasp.force <= min(MAX_FORCE, maximum_force(seen.affordance.fragility))
    lowest = min((grasp.rotation() @ np.array([x, y, 0.0088]))[2] for x in (-0.0105, 0.0105) for y in (-0.01, 0.01))
    assert grasp.position[2] + lowest >= 0.001
    assert math.isclose(float(np.linalg.norm(grasp.approach)), 1.0, abs_tol=1e-9)
    assert grasp.approach[2] <= 1e-9
    assert len(plan.joints) == 7


@QUICK
@given(kind=KINDS, place=PLACES, bearing=st.floats(-math.pi, math.pi), gap=st.floats(0.03, 0.12))
def test_no_plan_sweeps_through_a_neighbour(
    kind: str, place: tuple[float, float, float], bearing: float, gap: float
) -> None:
    """Whatever was planned keeps the clearance it states from the neighbour's observed points."""
    seen = thing(kind, "t", *place)
    distance = gap + seen.size[0] / 2 + 0.035
    other = bottle("n", place[0] + distance * math.cos(bearing), place[1] + distance * math.sin(bearing))
    plan = plan_of(seen, other)
    if plan is not None:
        assert swept_clearance(plan.grasp, other.surface_points()) >= min(plan.clearance, 0.02) - 0.003
        assert plan.clearance >= -0.001


@QUICK
@given(kind=KINDS, place=PLACES, scale=st.floats(0.3, 1.0))
def test_less_force_is_never_more_force(kind: str, place: tuple[float, float, float], scale: float) -> None:
    """A smaller force scale never raises the force."""
    seen = thing(kind, "t", *place)
    full, cut = plan_of(seen), plan_of(seen, constraints=Constraints(adjustment=Adjustment(force_scale=scale)))
    if full is not None and cut is not None:
        assert cut.grasp.force <= full.grasp.force + 1e-9


@QUICK
@given(kind=KINDS, place=PLACES)
def test_candidates_have_unique_names_and_unit_directions(kind: str, place: tuple[float, float, float]) -> None:
    """Names identify candidates; every approach is a unit vector that doesn't come from below."""
    found = generate_candidates(thing(kind, "t", *place))
    assert len({item.name for item in found}) == len(found)
    assert all(math.isclose(math.hypot(*item.approach), 1.0, abs_tol=1e-9) for item in found)
    assert all(item.approach[2] <= 1e-9 and item.room <= MAX_APERTURE for item in found)
    assert all(0.0 <= item.depth <= 1.0 for item in found)
