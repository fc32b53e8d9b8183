"""The Gymnasium environments: made by their ids, following the interface, and judged by the observer."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="needs the extra gym")

from bench.gym_env import GRASP_HIGH, GRASP_LOW, environment_name, register  # noqa: E402
from bench.suite import GROUPS  # noqa: E402


def _action(*numbers: float) -> np.ndarray:
    """The action that means these physical numbers."""
    unit = (np.asarray(numbers) - GRASP_LOW) / (GRASP_HIGH - GRASP_LOW)
    return (2.0 * unit - 1.0).astype(np.float32)


def test_every_task_has_an_environment() -> None:
    """All twelve tasks and the four supplementary ones are registered under the names of their scenes."""
    assert set(register()) == {environment_name(scene) for group in GROUPS.values() for scene in group}
    assert environment_name("cup_near_vase") == "AgenticRagVlm/CupNearVase-v0"


def _checked(scene: str) -> None:
    """Gymnasium's own checker, whose every word counts as a fault."""
    from gymnasium.utils.env_checker import check_env

    env = gymnasium.make(environment_name(scene), render_mode="rgb_array", evaluator="analytic").unwrapped
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env, skip_render_check=True)


def test_environment_follows_the_interface() -> None:
    """Gymnasium's own checker finds nothing to say: spaces, determinism by seed, types of what is returned."""
    _checked("cup_near_vase")


@pytest.mark.long
@pytest.mark.parametrize("scene", [scene for group in GROUPS.values() for scene in group])
def test_every_environment_follows_the_interface(scene: str) -> None:
    """The same for each of the sixteen tasks."""
    _checked(scene)


def test_a_grasp_that_lifts_is_a_success() -> None:
    """A grasp across the cube's sides ends the episode with reward 1; the same in the empty air is a failure."""
    env = gymnasium.make("AgenticRagVlm/SingleCube-v0").unwrapped
    env.reset(seed=1, options={"world_seed": 10_001})
    cube = env.opened.placed.objects[0]
    x, y, _ = cube.position
    w, _, _, z = cube.quaternion
    yaw = (2.0 * np.arctan2(z, w) + np.pi / 2) % np.pi - np.pi / 2
    _, reward, terminated, truncated, info = env.step(_action(x, y + 0.2 * (-1) ** (y > 0), 0.03, 0, 0, yaw, 0.07, 15))
    assert (reward, terminated, truncated, info["is_success"]) == (0.0, False, False, False)
    observation, reward, terminated, _, info = env.step(_action(x, y, 0.025, 0.0, 0.0, yaw, 0.07, 15.0))
    assert (reward, terminated, info["is_success"], info["failure"]) == (1.0, True, True, None)
    assert env.observation_space.contains(observation)


def test_an_episode_has_four_grasps() -> None:
    """Without success the fourth grasp ends the episode by truncation, not before."""
    env = gymnasium.make("AgenticRagVlm/SingleApple-v0", evaluator="analytic").unwrapped
    env.reset(seed=2)
    nowhere = _action(0.80, 0.38, 0.20, 0.0, 0.0, 0.0, 0.05, 5.0)
    ends = [env.step(nowhere)[2:4] for _ in range(4)]
    assert ends == [(False, False)] * 3 + [(False, True)]
