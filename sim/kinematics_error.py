"""How far the compiled model's forward kinematics is from the closed form."""

from __future__ import annotations

import mujoco
import numpy as np

from sim.kinematics import forward
from sim.panda import Q_MAX, Q_MIN
from sim.world import World


def kinematics_error(world: World, rng: np.random.Generator, count: int = 200) -> float:
    """Largest difference of the tool point [m] over `count` random joint configurations."""
    model, data = world.model, mujoco.MjData(world.model)
    site = model.site("robot/tcp").id
    worst = 0.0
    for joints in rng.uniform(Q_MIN, Q_MAX, (count, 7)):
        data.qpos[world.index.arm] = joints
        mujoco.mj_kinematics(model, data)
        worst = max(worst, float(np.abs(data.site_xpos[site] - forward(joints)[:3, 3]).max()))
    return worst
