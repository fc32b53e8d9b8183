"""An unknown glass on a stem: the test lift presses it with hardly more than the grip."""

from __future__ import annotations

from agent import build_agent


def test_an_unknown_flute_is_lifted_without_a_jerk() -> None:
    """Gripped with 3 N, no body presses the flute with more than 4.3 N, from the first touch to the end of the shake; a test
    lift of half the duration pressed it with 7 N in this world."""
    result = build_agent(scene="ood_champagne_flute", seed=14_120).run("pick up the wine glass")
    verdict, attempts = result.goals[0].verdict, result.goals[0].attempts
    assert result.success
    assert len(attempts) == 1
    assert attempts[0].grasp is not None
    assert attempts[0].grasp.force < 3.1
    assert verdict is not None
    assert verdict.peak_force_n < 4.3
