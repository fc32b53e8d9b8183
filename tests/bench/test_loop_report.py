"""The measurement of the loop: intervals, seeds, and that every run counts."""

from __future__ import annotations

import pytest
from scipy.stats import binomtest

from bench.loop_report import main, parse_seeds, report, run_one, wilson
from kb.errors import BadInputError

TIMES = {"perception": 1.0, "retrieval": 0.1, "planning": 0.2, "execution": 0.5, "brain": 0.0, "total": 2.0}


def row(scene: str, seed: int, success: bool, claimed: bool, **more: object) -> dict[str, object]:
    """A run's row."""
    return {
        "scene": scene, "seed": seed, "success": success, "claimed": claimed, "crash": None, "attempts": 1,
        "first": success, "diagnosed": [], "observed": [] if success else ["SLIP"], "damage": 0, "required": 1,
        "satisfied": int(success), "times": TIMES, "to_plan_s": 1.3, "wall_s": 3.0, "warm": True, **more,
    }  # fmt: skip


@pytest.mark.parametrize(("successes", "count"), [(0, 10), (5, 10), (10, 10), (97, 100), (1, 1)])
def test_the_interval_is_wilsons(successes: int, count: int) -> None:
    """It agrees with scipy's Wilson interval."""
    interval = binomtest(successes, count).proportion_ci(method="wilson")
    assert wilson(successes, count) == pytest.approx((interval.low, interval.high))


def test_nothing_known_is_anything_possible() -> None:
    """Without runs the interval is all of [0, 1]."""
    assert wilson(0, 0) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("text", "seeds"), [("7", [7]), ("3,5", [3, 5]), ("10000-10002", [10000, 10001, 10002]), ("1-2,9", [1, 2, 9])]
)
def test_seeds(text: str, seeds: list[int]) -> None:
    """Numbers, lists and ranges with both ends."""
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize("text", ["", "x", "1-", "-3", "5-2", "1.5"])
def test_bad_seeds_are_refused(text: str) -> None:
    """Empty, malformed and backward ranges are bad input."""
    with pytest.raises(BadInputError):
        parse_seeds(text)


def test_a_crash_is_a_row_and_counts_as_a_failure() -> None:
    """A run that raises does not stop the measurement and is not left out."""
    made = run_one(("nowhere", 3, "rgbd", "mujoco", "full"))
    assert made["success"] is False
    assert "there is no scene 'nowhere'" in made["crash"]
    text = report([row("single_cup", 1, True, True), made], [], "t")
    assert "| all | 2 | 1 |" in text
    assert "BadInputError" in text


def test_the_report_counts_claims_against_observations() -> None:
    """False claims and missed successes are both said; successes are the observer's."""
    rows = [
        row("a", 1, True, True), row("a", 2, False, True), row("a", 3, True, False), row("b", 1, False, False),
    ]  # fmt: skip
    text = report(rows, [6.0, 8.0, 7.0], "t")
    assert "| a | 3 | 2 |" in text
    assert "| all | 4 | 2 |" in text
    assert "False claims of success: 1 of 4 runs; missed successes: 1." in text
    assert "| cold run (`ragvlm run` in a new process) | 3 | 7.00 | 8.00 |" in text
    assert "| a | 2 | 1 |  | SLIP | True |" in text


def test_bad_usage_ends_with_2(capsys: pytest.CaptureFixture[str]) -> None:
    """As for the other commands."""
    with pytest.raises(SystemExit) as caught:
        main(["--seeds", "five"])
    assert caught.value.code == 2
    assert "no seed and no range" in capsys.readouterr().err
