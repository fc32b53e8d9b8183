"""Wrong promotions under lies, over strategies with known chances."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bench.false_claims import Fate, Tally, executed_rates, learnt, main, report, tally
from kb.errors import BadInputError
from kb.store import ExperienceStore
from tools.learn_experience import LearnRules


def test_without_lies_nothing_useless_is_promoted_and_all_that_works_is() -> None:
    """Strategies that never work become entries to be avoided, those that always work become experiences."""
    found = tally([0.0] * 5 + [1.0] * 5, 0.0, 1)
    assert (found.count(False, "promoted"), found.count(False, "avoided")) == ((0, 5), (5, 5))
    assert (found.count(True, "promoted"), found.count(True, "trusted")) == ((5, 5), (5, 5))


def test_a_guard_that_asks_for_nothing_promotes_what_does_not_work() -> None:
    """One success and hardly any certainty asked for: with 60 % lies a useless strategy gets in, and is counted as wrong."""
    rng, header = np.random.default_rng(1), ExperienceStore.open().header
    fates = [learnt(0.0, 0.6, header, rng, LearnRules(needed=1, sure=0.51)) for _ in range(10)]
    assert sum(fate.promoted for fate in fates) >= 3


def test_counts_and_words() -> None:
    """One of four promotions is of a strategy that works in under half of its executions: 25 %."""
    found = Tally([Fate(1.0, True, False, True)] * 3 + [Fate(0.4, True, False, False), Fate(0.0, False, True, False)])
    assert (found.wrong("promoted"), found.wrong("trusted")) == ((1, 4), (0, 3))
    assert "Wrong promotions: 1 of 4 = 25.00 %" in report(found, 0.2)


def test_it_reads_what_was_executed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Rates are tenths, in the order of the keys; another file ends in one line; the same command says the same twice."""
    file = tmp_path / "x.json"
    file.write_text('{"successes": {"b": 10, "a": 0}}')
    assert executed_rates(file) == [0.0, 1.0]
    for _ in range(2):
        assert main(["--executed", str(file), "--share", "0.2"]) == 0
    first, second = capsys.readouterr().out.split("20 % of failed")[1:]
    assert first == second
    with pytest.raises(BadInputError, match="no outcomes"):
        executed_rates(tmp_path / "none.json")
