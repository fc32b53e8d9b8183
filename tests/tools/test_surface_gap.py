"""Laws of the cheap test whether two pieces touch."""

from __future__ import annotations

import numpy as np

from tools.scene_relations.solid import Piece
from tools.scene_relations.surface_gap import meet, piece_gap


def _piece(rng: np.random.Generator) -> Piece:
    kind = int(rng.integers(3))
    (x, y), (a, b) = rng.uniform(-0.15, 0.15, 2).tolist(), rng.uniform(0.01, 0.1, 2).tolist()
    low, high = sorted(rng.uniform(0.0, 0.3, 2).tolist())
    half, radius = ((a, b), 0.0) if kind == 0 else ((0.0, 0.0), a / 2)
    return Piece((x, y), half, float(rng.uniform(-3, 3)), radius, low, high, 0.03 if kind == 2 else 0.0)


def test_meeting_is_a_gap_of_nothing() -> None:
    """Boxes, discs and balls meet exactly where `piece_gap` is 0, also where they just touch."""
    rng = np.random.default_rng(3)
    pairs = [(_piece(rng), _piece(rng)) for _ in range(1500)]
    one, other = Piece((0, 0), (0.1, 0.1), 0.0, 0.0, 0.0, 0.1), Piece((0.2, 0), (0.1, 0.1), 0.0, 0.0, 0.0, 0.1)
    pairs.append((one, other))
    assert [meet(a, b) for a, b in pairs] == [piece_gap(a, b) == 0.0 for a, b in pairs]
    assert 100 < sum(meet(a, b) for a, b in pairs) < 1400
