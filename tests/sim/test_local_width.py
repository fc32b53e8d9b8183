"""Widths between the fingers: lines that meet nothing are left out without a trace."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import sim.local_width
from kb.grasp import Grasp
from sim.local_width import local_width
from tools.open_world import open_world


@pytest.mark.parametrize("scene", ["single_cup", "single_banana", "screwdriver_side_grasp"])
def test_lines_past_a_piece_need_not_be_cut(scene: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The width is the same, bit for bit, when every line is cut with every piece."""
    world = open_world(scene, 11_000).world
    mujoco.mj_kinematics(world.model, world.data)
    thing = next(thing for thing in world.placed.objects if not thing.fixed)
    rng, geoms, widths = np.random.default_rng(3), world.index.objects[thing.id].geoms, []
    grasps = [
        Grasp(
            position=tuple(np.add(thing.position, rng.uniform([-0.05, -0.05, 0.0], [0.05, 0.05, 0.1])).tolist()),
            approach=(0.0, 0.0, -1.0), yaw=float(rng.uniform(-1.5, 1.5)), aperture=0.07, force=5.0, type="power",
        )
        for _ in range(60)
    ]  # fmt: skip
    for every_piece in (False, True):
        if every_piece:
            monkeypatch.setattr(sim.local_width, "_met", lambda _m, _d, given, middles, _axis: [given] * len(middles))
        widths.append(
            [local_width(world.model, world.data, geoms, g.position, g.rotation(), g.aperture) for g in grasps]
        )
    assert widths[0] == widths[1]
    assert max(widths[0]) > 0.0
