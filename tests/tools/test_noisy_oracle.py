"""Errors of oracle perception in the analytic evaluator."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from kb.affordance import AffordanceDescriptor
from kb.percept import PerceivedObject, Percept
from tools.noisy_oracle import POSITION_NOISE, SIZE_NOISE, NoisyOracle

CUBE = PerceivedObject(
    id="obj_0",
    category="cube",
    confidence=1.0,
    position=(0.5, 0.0, 0.025),
    yaw=0.0,
    size=(0.05, 0.05, 0.05),
    shape="box",
    affordance=AffordanceDescriptor(type="GRASPABLE_BODY", material="wood", fragility=0.0, region="body"),
)


class Exact:
    """Sees many exact cubes."""

    def perceive(self, views: Any, args: Any) -> Percept:
        return Percept(look=args.look, perception="oracle", objects=(CUBE,) * 400)


def test_errors_have_the_stated_spread_and_follow_the_seed() -> None:
    """Positions scatter by 5, 5 and 3 mm, sizes by 3 %; the same seed and look repeat them exactly."""
    look = SimpleNamespace(look=0)
    seen = NoisyOracle(Exact(), 7).perceive((), look).objects
    offsets = np.array([item.position for item in seen]) - CUBE.position
    assert offsets.std(axis=0) == pytest.approx(POSITION_NOISE, rel=0.15)
    scales = np.array([item.size[0] for item in seen]) / 0.05
    assert scales.std() == pytest.approx(SIZE_NOISE, rel=0.15)
    assert NoisyOracle(Exact(), 7).perceive((), look).objects == seen
    assert NoisyOracle(Exact(), 7).perceive((), SimpleNamespace(look=1)).objects != seen
