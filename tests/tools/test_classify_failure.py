"""The robot's own word from its own sensing: claims, and the 14 types by the first anomalous event."""

from __future__ import annotations

from typing import Any

import pytest

from kb.constraint import Adjustment, Constraint, Constraints
from kb.percept import PerceivedObject, Percept
from kb.sensing import CameraEvidence, Evidence, PlaceEvidence, Plan, Sensing
from tests.planning_fixtures import context, percept, solid
from tools.classify_failure import ClassifyArgs, Diagnosis, classify_failure
from tools.plan_grasp import PlanArgs, plan_grasp

CUBE = solid("t", "cube", 0.5, 0.1, 0.3)
BANANA = solid("t", "screwdriver", 0.5, 0.1, 0.3)
GOOD: dict[str, Any] = {
    "phase": "shake",
    "aperture_start": 0.08,
    "aperture_closed": 0.05,
    "aperture_lifted": 0.05,
    "aperture_end": 0.05,
    "motor_force_closed": 8.0,
    "motor_force_end": 8.0,
    "closing_force_peak": 8.0,
    "load_lifted": 0.09,
    "load_end": 0.09,
    "load_min": 0.07,
    "lift_height": 0.17,
    "held_s": 5.2,
}


def plan_of(seen: PerceivedObject, others: Percept | None = None) -> Plan:
    plan = plan_grasp(PlanArgs(percept=others or percept(seen), target="t"), context()).plan
    assert plan is not None
    return plan


def diagnosed(
    seen: PerceivedObject = CUBE,
    *,
    plan: Plan | None = None,
    scene: Percept | None = None,
    camera: CameraEvidence | None = None,
    places: PlaceEvidence | None = None,
    constraints: Constraints | None = None,
    **changes: Any,
) -> Diagnosis:
    scene = scene or percept(seen)
    args = ClassifyArgs(
        plan=plan or plan_of(seen, scene),
        evidence=Evidence(sensing=Sensing.model_validate(GOOD | changes), camera=camera, places=places),
        constraints=constraints or Constraints(),
        target=seen,
        percept=scene,
    )
    return classify_failure(args, context())


def bent(plan: Plan, **changes: Any) -> Plan:
    return plan.model_copy(update={"grasp": plan.grasp.model_copy(update=changes)})


def test_a_clean_lift_is_claimed() -> None:
    """Load through hold and shake, the cube's width between the fingers, 17 cm up: success, no failure type."""
    found = diagnosed()
    assert (found.claimed, found.failure) == (True, None)
    assert "0.090 kg" in found.reasons[0]


@pytest.mark.parametrize(
    "changes",
    [
        {"aperture_end": 0.0005},
        {"held_s": 1.0},
        {"lift_height": 0.06},
        {"load_end": 0.0},
        {"stopped_by": "force", "phase": "approach"},
        {"reachable": False, "phase": "plan"},
        {"closing_force_peak": 80.0},
        {"load_lifted": 0.03},
        {"aperture_end": 0.038},
    ],
)
def test_any_contradiction_forbids_the_claim(changes: dict[str, Any]) -> None:
    """Each reading alone that contradicts a success is enough, and a failure type is given."""
    found = diagnosed(**changes)
    assert not found.claimed
    assert found.failure is not None
    assert found.reasons


@pytest.mark.parametrize(
    ("changes", "failure"),
    [
        ({"reachable": False, "ik_residual": 0.1, "phase": "plan"}, "UNREACHABLE_POSE"),
        ({"stopped_by": "timeout"}, "TIMEOUT"),
        ({"stopped_by": "stop"}, "UNKNOWN"),
        ({"stopped_by": "force", "phase": "transit"}, "COLLISION"),
        ({"aperture_closed": 0.0, "aperture_end": 0.0, "load_end": 0.0, "load_lifted": 0.0}, "POSITION_ERROR"),
        ({"load_lifted": 0.01, "load_end": 0.0, "held_s": 0.2, "aperture_end": 0.04}, "SLIP"),
        ({"load_lifted": 0.09, "load_end": 0.0, "held_s": 3.0, "aperture_end": 0.0}, "DROP"),
        ({"closing_force_peak": 95.0}, "FORCE_DAMAGE"),
    ],
)
def test_the_first_anomaly_names_the_failure(changes: dict[str, Any], failure: str) -> None:
    """One reading per type, in the order of the phases."""
    assert diagnosed(**changes).failure == failure


def test_too_much_force_on_compliant_things_is_deformation() -> None:
    """An apple gives way where a cup breaks."""
    assert diagnosed(solid("t", "apple", 0.5, 0.1), closing_force_peak=69.0).failure == "DEFORMATION"


def test_an_abort_on_the_object_is_a_matter_of_width_position_or_yaw() -> None:
    """Too little opening: width; enough, but beside the middle: position; enough only across: orientation."""
    plan = plan_of(CUBE)
    stop = {"stopped_by": "force", "phase": "approach", "abort_force": 40.0}
    assert diagnosed(plan=bent(plan, aperture=0.044), **stop).failure == "WIDTH_MISMATCH"
    x, y, z = plan.grasp.position
    axis = plan.grasp.closing_axis()
    moved = bent(plan, position=(x + 0.028 * axis[0], y + 0.028 * axis[1], z))
    assert diagnosed(plan=moved, **stop).failure == "POSITION_ERROR"
    tool = plan_of(BANANA)
    turned = bent(tool, yaw=tool.grasp.yaw + 1.2, aperture=0.055)
    assert diagnosed(BANANA, plan=turned, **stop).failure == "ORIENTATION"


def test_an_abort_low_above_the_table_is_the_approach() -> None:
    """Fingertips aimed below the table's top, clear of the object."""
    plan = plan_of(CUBE)
    x, y, _ = plan.grasp.position
    low = bent(plan, position=(x + 0.10, y, 0.002))
    assert diagnosed(plan=low, stopped_by="force", phase="approach").failure == "APPROACH_ANGLE"


def test_an_abort_next_to_a_neighbour_is_a_collision() -> None:
    """The hand's way leads through a bottle beside the target."""
    scene = percept(CUBE, solid("n", "bottle", 0.5, 0.21))
    plan = bent(plan_of(CUBE), yaw=1.57)
    assert diagnosed(plan=plan, scene=scene, stopped_by="force", phase="approach").failure == "COLLISION"


def test_a_surprising_width_is_cleared_by_a_look_that_shows_the_target_gone() -> None:
    """Soft doubt: 62 mm instead of 50; seen gone it is claimed, seen standing there it is the wrong object."""
    odd = {"aperture_closed": 0.062, "aperture_lifted": 0.062, "aperture_end": 0.062}
    assert not diagnosed(**odd).claimed
    assert diagnosed(**odd, camera=CameraEvidence(target_visible=False)).claimed
    still = diagnosed(**odd, camera=CameraEvidence(target_visible=True, target_moved=0.003))
    assert (still.claimed, still.failure) == (False, "WRONG_OBJECT")


def test_the_place_that_became_empty_tells_what_is_held() -> None:
    """All readings are those of a success, but the twin's place is empty: the wrong object, after the put-back, too."""
    twin = PlaceEvidence(target="occupied", emptied=("n",))
    found = diagnosed(places=twin)
    assert (found.claimed, found.failure) == (False, "WRONG_OBJECT")
    again = diagnosed(places=twin, camera=CameraEvidence(target_visible=True, others_moved={"n": 0.012}))
    assert again.failure == "WRONG_OBJECT"
    hidden = PlaceEvidence(target="unseen", emptied=("n",), unseen=("m",))
    assert diagnosed(places=hidden).failure == "WRONG_OBJECT"


def test_a_hidden_place_is_no_doubt() -> None:
    """Nothing is seen of the target's place, and nothing of another's: what was felt to be a success stays one."""
    assert diagnosed(places=PlaceEvidence(target="unseen", unseen=("n",))).claimed
    assert diagnosed(places=PlaceEvidence(target="empty", unseen=("n",))).claimed


def test_heavy_is_not_wrong() -> None:
    """Five times the expected mass: a success where the target's place is empty, also after a look that is put back."""
    heavy = {"load_lifted": 0.6, "load_end": 0.6}
    assert not diagnosed(**heavy).claimed
    assert diagnosed(**heavy, places=PlaceEvidence(target="empty")).claimed
    lost = {"load_lifted": 0.2, "load_end": 0.6}
    back = CameraEvidence(target_visible=True, target_moved=0.004)
    assert diagnosed(**lost, places=PlaceEvidence(target="empty"), camera=back).failure == "SLIP"


def test_a_neighbour_that_left_with_the_target_forbids_the_claim() -> None:
    """The target is in the hand, and something else is nowhere any more."""
    assert not diagnosed(places=PlaceEvidence(target="empty", emptied=("n",))).claimed


def test_a_protected_neighbour_that_moved_is_a_violation() -> None:
    """All readings are fine, but the vase that the constraint protects has moved and something vanished."""
    rules = Constraints(active=(Constraint(kind="collision", target="n", reason="fragile"),), adjustment=Adjustment())
    camera = CameraEvidence(target_visible=False, others_moved={"n": 0.03}, missing=("m",))
    assert diagnosed(camera=camera, constraints=rules).failure == "CONSTRAINT_VIOLATION"


def test_spilt_contents_are_felt() -> None:
    """With contents to keep, a tenth of the load lost is no success."""
    rules = Constraints(active=(Constraint(kind="content", target="t", reason="filled"),))
    assert not diagnosed(constraints=rules, load_lifted=0.105, load_end=0.09).claimed


def test_only_observables_go_in() -> None:
    """The arguments hold plan, sensing, looks and constraints: no field of the observer's verdict."""
    assert set(ClassifyArgs.model_fields) == {"plan", "evidence", "constraints", "target", "percept"}
    assert set(Evidence.model_fields) == {"sensing", "camera", "places"}


def test_a_wide_thing_taken_by_its_edge_may_still_rest_on_its_far_end() -> None:
    """A plate of 20 cm tilts by a few degrees in the hand: what its far end bears after 2 cm is no doubt, a bowl's is one."""
    for width, claimed in ((0.20, True), (0.12, False)):
        seen = solid("t", "bowl", 0.5, 0.1)
        seen = seen.model_copy(update={"size": (width, width, 0.05)})
        plan = plan_of(CUBE)
        x, y, z = seen.position
        plan = bent(plan, position=(x + width / 2, y, z)).model_copy(update={"region": "rim", "local_width": 0.005})
        found = diagnosed(
            seen,
            plan=plan,
            load_lifted=0.0,
            load_end=0.3,
            aperture_closed=0.005,
            aperture_lifted=0.005,
            aperture_end=0.005,
        )
        assert found.claimed == claimed, found.reasons
