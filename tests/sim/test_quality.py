"""Numbers of the quality model that follow from its printed formulas."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kb.grasp import Grasp
from sim.quality import Circumstances, Subject, failure_of, grade, maximum_force, minimum_force

GRASP = Grasp(position=(0.5, 0, 0.03), approach=(0, 0, -1), yaw=0.0, aperture=0.06, force=10.0, type="power")
CUBE = Subject(
    region_distance=0.0,
    width=0.05,
    mass=0.09,
    friction=0.6,
    fragility=0.0,
    affordance="GRASPABLE_BODY",
    clearance=0.03,
)


def test_a_good_grasp_of_the_cube_is_rated_high() -> None:
    """A centred power grasp of the wood cube opened 1 cm wider than it gets 1 in every factor but difficulty."""
    quality = grade(GRASP, CUBE)
    assert quality.phi == pytest.approx((1, 1, 1, 1, 1, 1 - 0.3 * 0.05 / 0.08 - 0.2 * 0.09, 1))
    assert quality.q == pytest.approx(0.97945)
    assert failure_of(quality, GRASP, CUBE, Circumstances()) is None


def test_force_band_follows_mass_friction_and_fragility() -> None:
    """f_min = 1.5 m (g + 1) / (2 mu) and f_max = 70 (1 - frag), at least 5 N (ledger G15)."""
    assert minimum_force(0.35, 0.5) == pytest.approx(5.675, abs=1e-3)
    assert maximum_force(0.9) == pytest.approx(7.0)
    assert maximum_force(1.0) == 5.0


@pytest.mark.parametrize(
    ("change", "facts", "failure"),
    [
        ({}, {"reachable": False}, "UNREACHABLE_POSE"),
        ({}, {"correct_object": False}, "WRONG_OBJECT"),
        ({}, {"timed_out": True}, "TIMEOUT"),
        ({"clearance": 0.0}, {"blocked_by": "object"}, "COLLISION"),
        ({"clearance": 0.0}, {"blocked_by": "table"}, "APPROACH_ANGLE"),
        ({"region_distance": 0.03}, {}, "POSITION_ERROR"),
        ({"width": 0.059}, {}, "WIDTH_MISMATCH"),
        ({"affordance": "GRASPABLE_EDGE"}, {}, "ORIENTATION"),
        ({}, {"normal_outside_cone": True}, "ORIENTATION"),
        ({"fragility": 1.0}, {"material": "glass"}, "FORCE_DAMAGE"),
        ({"fragility": 1.0}, {"material": "organic"}, "DEFORMATION"),
        ({"mass": 1.0}, {}, "SLIP"),
        ({"mass": 1.5}, {}, "DROP"),
        ({}, {"constraint_violated": True}, "CONSTRAINT_VIOLATION"),
        (
            {"region_distance": 0.02, "mass": 0.75, "clearance": 0.008, "width": 0.025, "affordance": "TOOL_HANDLE"},
            {},
            "UNKNOWN",
        ),
    ],
)
def test_each_low_factor_has_its_failure(change: dict, facts: dict, failure: str) -> None:
    """The decision list of ledger G17 yields each of the 14 types, first match winning."""
    subject = replace(CUBE, **change)
    assert failure_of(grade(GRASP, subject), GRASP, subject, Circumstances(**facts)) == failure
