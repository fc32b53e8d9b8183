"""Oracle perception with the errors that the analytic evaluator assumes (benchmark.md section 2; ledger G16).

It perturbs what the oracle reports and reads no truth itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kb.base import Vec3
from kb.percept import Part, PerceivedObject, Percept

POSITION_NOISE = (0.005, 0.005, 0.003)
"""Standard deviation of positions along x, y, z [m]."""
SIZE_NOISE = 0.03
"""Relative standard deviation of sizes."""


class NoisyOracle:
    """A perceiver around another one; the same seed and look give the same errors."""

    def __init__(self, perceiver: Any, seed: int) -> None:
        self.perceiver = perceiver
        self.seed = seed

    def perceive(self, views: Any, args: Any) -> Percept:
        """What the inner perceiver sees, with errors."""
        percept: Percept = self.perceiver.perceive(views, args)
        rng = np.random.default_rng([self.seed, percept.look])
        return percept.model_copy(update={"objects": tuple(_disturb(seen, rng) for seen in percept.objects)})


def _disturb(seen: PerceivedObject, rng: np.random.Generator) -> PerceivedObject:
    shift = rng.normal(0.0, POSITION_NOISE)
    scale = float(1.0 + rng.normal(0.0, SIZE_NOISE))
    centre = np.asarray(seen.position)

    def moved(point: Vec3) -> Vec3:
        x, y, z = centre + scale * (np.asarray(point) - centre) + shift
        return (float(x), float(y), float(z))

    def part(old: Part) -> Part:
        radius = None if old.radius is None else old.radius * scale
        changes = {"centre": moved(old.centre), "width": old.width * scale, "length": old.length * scale}
        return old.model_copy(update={**changes, "radius": radius})

    a, b, c = seen.size
    return seen.model_copy(
        update={
            "position": moved(seen.position),
            "size": (a * scale, b * scale, c * scale),
            "parts": tuple(part(old) for old in seen.parts),
        }
    )
