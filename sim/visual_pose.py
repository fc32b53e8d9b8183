"""Where every body of the visual model is for given joint positions; for live views and replays."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.placed import PlacedScene
from sim.visual_model import visual_model


class VisualPose:
    """The visual model of one scene with its kinematics; it is never simulated."""

    def __init__(self, placed: PlacedScene) -> None:
        self.model = visual_model(placed)
        self._data = mujoco.MjData(self.model)

    def at(self, qpos: NDArray[np.float64]) -> mujoco.MjData:
        """The model's data with all body poses for joint positions `qpos` (nq,) of the physical model."""
        self._data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, self._data)
        return self._data
