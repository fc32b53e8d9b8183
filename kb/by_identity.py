"""Results kept for the very same objects: the configurations of a trial reckon with the same percepts again and again."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

T = TypeVar("T")


class ByIdentity(Generic[T]):
    """The latest results of a pure function of objects that nobody changes.

    Two objects are the same if they are one object, which is told without looking into them; each is kept as long as its
    result, so that no other can get its identity.
    """

    def __init__(self, size: int) -> None:
        """Keeps the `size` latest results."""
        self._size = size
        self._known: dict[tuple[tuple[int, ...], Hashable], tuple[tuple[object, ...], T]] = {}

    def get(self, objects: tuple[object, ...], also: Hashable, make: Callable[[], T]) -> T:
        """What `make` gave for these objects and the value `also`, made unless it is known."""
        key = tuple(map(id, objects)), also
        known = self._known.get(key)
        if known is None:
            known = objects, make()
            while len(self._known) >= self._size:
                self._known.pop(next(iter(self._known)), None)
            self._known[key] = known
        return known[1]
