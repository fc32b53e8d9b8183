"""The correction rules as data."""

from __future__ import annotations

import pytest

from kb.corrections import correction_rule, correction_rules, level_of_attempt
from kb.errors import BadInputError
from kb.vocabulary import FAILURE_TYPES


def test_every_failure_type_has_a_rule_that_changes_something() -> None:
    """14 rules in the order of the taxonomy, each with a change or an action."""
    rules = correction_rules()
    assert tuple(rules) == FAILURE_TYPES
    assert all(rule.scale or rule.add or rule.set or rule.actions for rule in rules.values())
    assert len({rule.name for rule in rules.values()}) == 14


def test_the_two_rules_of_the_paper_are_exact() -> None:
    """SLIP multiplies the force by 1.2; WIDTH_MISMATCH adds 0.01 m to the aperture (Sec. IV-B)."""
    assert correction_rule("SLIP").scale == {"force": 1.2}
    assert correction_rule("WIDTH_MISMATCH").add == {"aperture": 0.01}


@pytest.mark.parametrize(("levels", "expected"), [("resolved", [1, 2, 3]), ("as_written", [1, 1, 2])])
def test_levels_follow_the_attempt_being_prepared(levels: str, expected: list[int]) -> None:
    """Resolved: attempts 1-3 use levels 1-3. As written: level 3 is never reached within the budget (ledger G19)."""
    assert [level_of_attempt(attempt, levels) for attempt in (1, 2, 3)] == expected  # type: ignore[arg-type]


def test_the_first_attempt_has_no_correction_level() -> None:
    """Attempt 0 is no retry."""
    with pytest.raises(BadInputError, match="retries count from 1"):
        level_of_attempt(0)
