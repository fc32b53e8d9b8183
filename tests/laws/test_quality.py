"""Laws of the seven-factor quality model, checked over random grasps and objects."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kb.grasp import Grasp
from kb.vocabulary import AFFORDANCE_TYPES, GraspType
from sim.quality import THRESHOLDS, WEIGHTS, Circumstances, Subject, failure_of, grade, maximum_force, passes

subjects = st.builds(
    Subject,
    region_distance=st.floats(0.0, 0.1),
    width=st.floats(0.001, 0.12),
    mass=st.floats(0.005, 3.0),
    friction=st.floats(0.1, 1.2),
    fragility=st.floats(0.0, 1.0),
    affordance=st.sampled_from(AFFORDANCE_TYPES),
    clearance=st.floats(-0.05, 0.3),
)
grasps = st.builds(
    Grasp,
    position=st.just((0.5, 0.0, 0.05)),
    approach=st.just((0.0, 0.0, -1.0)),
    yaw=st.floats(-3.0, 3.0),
    aperture=st.floats(0.0, 0.08),
    force=st.floats(1.0, 70.0),
    type=st.sampled_from(get_args(GraspType)),
)
fewer = settings(max_examples=150, deadline=None)


@fewer
@given(grasps, subjects)
def test_q_and_every_factor_lie_between_0_and_1(grasp: Grasp, subject: Subject) -> None:
    """Q and each phi_k lie in [0, 1], and Q is the weighted sum of Eq. (2)."""
    quality = grade(grasp, subject)
    assert all(0.0 <= value <= 1.0 for value in quality.phi)
    assert 0.0 <= quality.q <= 1.0
    assert quality.q == pytest.approx(sum(w * p for w, p in zip(WEIGHTS, quality.phi, strict=True)))


def test_weights_are_the_papers_and_sum_to_one() -> None:
    """The weights of Sec. IV-D sum to 1, and difficulty alone has no threshold (ledger G15)."""
    assert WEIGHTS == (0.20, 0.15, 0.10, 0.15, 0.15, 0.10, 0.15)
    assert sum(WEIGHTS) == pytest.approx(1.0)
    assert [k for k, theta in enumerate(THRESHOLDS, 1) if theta == 0.0] == [6]


@fewer
@given(grasps, subjects, st.floats(0.0, 0.05))
def test_more_position_error_is_never_better(grasp: Grasp, subject: Subject, more: float) -> None:
    """phi_1 and Q fall, or stay, as the grasp moves away from the region."""
    worse = grade(grasp, replace(subject, region_distance=subject.region_distance + more))
    assert worse.phi[0] <= grade(grasp, subject).phi[0]
    assert worse.q <= grade(grasp, subject).q + 1e-12


@fewer
@given(grasps, subjects, st.floats(0.0, 0.2))
def test_more_clearance_is_never_worse(grasp: Grasp, subject: Subject, more: float) -> None:
    """phi_5 and Q rise, or stay, with the clearance of the swept hand."""
    better = grade(grasp, replace(subject, clearance=subject.clearance + more))
    assert better.q >= grade(grasp, subject).q - 1e-12


@fewer
@given(grasps, subjects, st.floats(1.0, 3.0))
def test_heavier_or_slipperier_is_never_more_secure(grasp: Grasp, subject: Subject, factor: float) -> None:
    """phi_7 and phi_6 never rise with mass; phi_7 never rises as friction falls."""
    before, heavy = grade(grasp, subject), grade(grasp, replace(subject, mass=subject.mass * factor))
    slippery = grade(grasp, replace(subject, friction=subject.friction / factor))
    assert heavy.phi[6] <= before.phi[6]
    assert heavy.phi[5] <= before.phi[5]
    assert slippery.phi[6] <= before.phi[6]


@fewer
@given(grasps, subjects, st.floats(1.0, 70.0))
def test_force_factor_has_one_hill(grasp: Grasp, subject: Subject, force: float) -> None:
    """phi_3 never falls between two forces below f_max, nor rises between two above f_max (one hill)."""
    low, high = sorted((grasp.force, force))
    at_low = grade(grasp.model_copy(update={"force": low}), subject).phi[2]
    at_high = grade(grasp.model_copy(update={"force": high}), subject).phi[2]
    if high <= maximum_force(subject.fragility):
        assert at_low <= at_high
    if low >= maximum_force(subject.fragility) and low >= 1.5 * subject.mass * 10.81 / (2 * subject.friction):
        assert at_low >= at_high


@fewer
@given(grasps, subjects)
def test_a_grasp_too_narrow_for_the_object_has_no_width_factor(grasp: Grasp, subject: Subject) -> None:
    """phi_2 is 0 whenever the opening leaves less than 2 mm, or the object is wider than 78 mm."""
    if grasp.aperture < subject.width + 0.002 or subject.width > 0.078:
        assert grade(grasp, subject).phi[1] == 0.0


@fewer
@given(grasps, subjects)
def test_no_failure_exactly_when_the_quality_passes(grasp: Grasp, subject: Subject) -> None:
    """With nothing else wrong, the decision list names a failure if and only if phi or Q falls short (ledger G16)."""
    quality = grade(grasp, subject)
    assert (failure_of(quality, grasp, subject, Circumstances()) is None) == passes(quality)


def test_level_3_noise_alone_never_fails_the_position() -> None:
    """The largest level-3 perturbation (1 cm on each axis) leaves phi_1 above its threshold (ledger G15)."""
    grasp = Grasp(position=(0, 0, 0), approach=(0, 0, -1), yaw=0, aperture=0.06, force=10, type="power")
    subject = Subject(0.01 * 3**0.5, 0.05, 0.1, 0.5, 0.0, "GRASPABLE_BODY", 0.03)
    assert grade(grasp, subject).phi[0] == pytest.approx(0.567, abs=1e-3)
    assert passes(grade(grasp, subject))
