"""Retrieval over many entries: the sieves change nothing of the answer."""

from __future__ import annotations

import pytest

from bench.kb_scale import measure


@pytest.mark.parametrize("precise", [True, False])
def test_the_sieve_finds_what_exact_scoring_finds(precise: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """At 1200 entries, with columns in double and in single precision, recall@3 against scoring every entry is 1."""
    monkeypatch.setattr("kb.experience_table.EXACT_LIMIT", 5000 if precise else 1000)
    row = measure(1200, count=20, memory=False)
    assert row["known_recall_at_3"] == 1.0
    assert row["fallback_recall_at_3"] == 1.0


def test_retrieval_is_fast_enough_at_the_shipped_size() -> None:
    """Median processor time at 116 entries is at most 5 ms."""
    row = measure(116, count=25, memory=False)
    assert row["known_p50_ms"] <= 5.0
    assert row["fallback_p50_ms"] <= 5.0
