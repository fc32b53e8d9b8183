"""Task IT-b: the ball must be hidden from the front camera by the box (ledger G51)."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from sim.build_model import build_model
from sim.cameras import cast
from sim.placed import PlacedScene

LEAST_HIDDEN = 0.60
"""Share of the target's pixels that the front camera must not see (benchmark.md section 3)."""


def mostly_hidden(placed: PlacedScene) -> bool:
    """Whether at least 60 % of the task's target is hidden in the front view."""
    target = placed.task.target if placed.task is not None else None
    return target is not None and hidden_share(placed, target) >= LEAST_HIDDEN


def hidden_share(placed: PlacedScene, name: str) -> float:
    """Share of the object's pixels in the front view, seen alone, that other objects hide; in [0, 1]."""
    alone = tuple(thing for thing in placed.objects if thing.id == name)
    seen, whole = (_pixels(replace(placed, objects=things), name) for things in (placed.objects, alone))
    return 1.0 - seen / whole if whole else 1.0


def _pixels(placed: PlacedScene, name: str) -> int:
    model = build_model(replace(placed, particles=()), check=False)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    front = replace(placed.cameras[0], width=320, height=240)
    geoms = np.flatnonzero(model.geom_bodyid == model.body(name).id)
    return int(np.isin(cast(model, data, front, placed).geom, geoms).sum())
