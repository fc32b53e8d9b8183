"""Keeping results by the identity of what they follow from."""

from __future__ import annotations

from kb.by_identity import ByIdentity


def test_the_same_objects_are_asked_once_and_equal_ones_anew() -> None:
    """One object gives the kept result; an equal one, another order and another value are worked out on their own."""
    known: ByIdentity[object] = ByIdentity(8)
    one, twin = [1.0], [1.0]
    first = known.get((one, twin), "a", object)
    assert known.get((one, twin), "a", object) is first
    assert known.get((twin, one), "a", object) is not first
    assert known.get((one, one), "a", object) is not first
    assert known.get((one, twin), "b", object) is not first


def test_the_oldest_goes_first_and_identities_are_not_reused() -> None:
    """Beyond its size the oldest result is made again; a kept object lives on, so that no new one takes its identity."""
    known: ByIdentity[int] = ByIdentity(2)
    made: list[int] = []

    def make(number: int) -> int:
        made.append(number)
        return number

    for number in range(50):
        assert known.get(([number],), None, lambda number=number: make(number)) == number
    assert made == list(range(50))
