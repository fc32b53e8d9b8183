"""The tasks as Gymnasium environments: one action is one grasp (and, where the task asks for it, where it is put).

    import gymnasium
    import bench.gym_env  # registers AgenticRagVlm/...
    env = gymnasium.make("AgenticRagVlm/CupNearVase-v0")

The observation is what the robot gets (pictures, joints, opening); reward and `info` are the observer's word. An episode
is a trial of the benchmark: four grasps at most, ended by success or by damage. Tasks that clear or sort the table take a
grasp and a place per step. Needs the extra `gym`.
"""

from __future__ import annotations

import math
from typing import Any, SupportsFloat

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from bench.suite import GROUPS, instruction_of
from kb.grasp import MAX_APERTURE, Grasp
from tools.open_world import OpenedWorld, open_world

NAMESPACE = "AgenticRagVlm"
SEEDS = 10_000
"""Worlds of episodes whose seed is not given are drawn from 10000 to 19999: never those of the evaluation."""
ATTEMPTS = 4
"""Grasps per object (ledger A4.1: one and three retries)."""
GRASP_LOW = np.array([0.25, -0.40, 0.0, 0.0, -math.pi, -math.pi / 2, 0.0, 1.0])
GRASP_HIGH = np.array([0.85, 0.40, 0.30, math.pi / 2, math.pi, math.pi / 2, MAX_APERTURE, 40.0])
"""Bounds of x, y, z of the point between the fingers [m], tilt of the approach off straight down and heading of that
tilt [rad], azimuth of the closing axis [rad], opening [m] and force [N]; the action's -1 and 1."""
PLACE_LOW, PLACE_HIGH = np.array([0.25, -0.40, 0.0]), np.array([0.85, 0.65, 0.40])
"""Bounds of the place where what is held is put [m]; the bin stands at y = 0.55."""
FAR = 10.0
"""No camera is farther than that from the robot's base [m]; nor does its depth reach farther."""

Array = NDArray[np.float64]
Observation = dict[str, NDArray[Any]]


class GraspEnv(gymnasium.Env[Any, NDArray[np.float32]]):
    """One task. `step` makes the robot carry out one grasp from start to end."""

    metadata = {"render_modes": ["rgb_array"]}  # noqa: RUF012  (gymnasium's own attribute)

    def __init__(
        self, scene: str, *, render_mode: str | None = None, evaluator: Any = "mujoco", noise: float = 1.0
    ) -> None:
        """Args: name of a scene with a task, "rgb_array" or None, evaluator, scale of the uncertainties."""
        self.scene = scene
        self.render_mode = render_mode
        self._evaluator = evaluator
        self._noise = noise
        opened = self._open(SEEDS)
        self._task = opened.placed.task
        assert self._task is not None
        self._places = self._task.kind != "pick"
        camera = opened.placed.cameras[0]
        shape = (camera.height, camera.width)
        low = np.concatenate([GRASP_LOW, PLACE_LOW]) if self._places else GRASP_LOW
        high = np.concatenate([GRASP_HIGH, PLACE_HIGH]) if self._places else GRASP_HIGH
        self._low, self._high = low, high
        self.action_space = spaces.Box(-1.0, 1.0, (len(low),), np.float32)
        views: dict[str, spaces.Space[Any]] = {}
        for name in ("front", "top"):
            views[f"{name}_rgb"] = spaces.Box(0, 255, (*shape, 3), np.uint8)
            views[f"{name}_depth"] = spaces.Box(0.0, FAR, shape, np.float32)
            views[f"{name}_pose"] = spaces.Box(-FAR, FAR, (4, 4), np.float64)
        views["joints"] = spaces.Box(-np.pi, np.pi, (7,), np.float64)
        views["opening"] = spaces.Box(0.0, 0.1, (1,), np.float64)
        self.observation_space = spaces.Dict(views)
        self._opened = opened

    @property
    def opened(self) -> OpenedWorld:
        """The world of the episode; for tests and pictures."""
        return self._opened

    def _open(self, seed: int) -> OpenedWorld:
        return open_world(self.scene, seed, evaluator=self._evaluator, noise=self._noise)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """A new trial.

        Args:
            seed: seeds the episode; the same seed gives the same world.
            options: `world_seed` names the world outright, as `--seed` of the command line does.
        """
        super().reset(seed=seed)
        given = (options or {}).get("world_seed")
        world_seed = SEEDS + int(self.np_random.integers(SEEDS)) if given is None else int(given)
        self._opened = self._open(world_seed)
        self._steps = 0
        movable = sum(not thing.fixed for thing in self._opened.placed.objects)
        self._most = ATTEMPTS * (movable if self._places else 1)
        instruction = instruction_of(self.scene, world_seed)
        return self._observation(), {"instruction": instruction, "world_seed": world_seed, "is_success": False}

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, SupportsFloat, bool, bool, dict[str, Any]]:
        """One grasp, and the place if the task has one; then the hand is empty again unless the grasp succeeded."""
        robot, observer = self._opened.robot, self._opened.observer
        numbers = self._low + (np.clip(np.asarray(action, float), -1.0, 1.0) + 1.0) / 2.0 * (self._high - self._low)
        grasp = grasp_of(numbers[:8])
        sensing = robot.grasp(grasp)
        meant = self._task.target if self._task else None
        seen = observer.judge(self._opened.motions, meant)
        self._steps += 1
        if self._places and robot.holding:
            x, y, z = (float(value) for value in numbers[8:])
            robot.place((x, y, z))
        success = self._cleared() if self._places else bool(seen.success)
        if not success:
            robot.release_and_home()
        damage = observer.damaged()
        terminated = success or bool(damage)
        info = {
            "is_success": success,
            "failure": seen.failure,
            "damage": list(damage),
            "lifted_m": seen.verdict.lifted_m,
            "stopped_by": sensing.stopped_by,
        }
        return self._observation(), float(success), terminated, self._steps >= self._most and not terminated, info

    def _cleared(self) -> bool:
        """Whether everything is where a task that clears or sorts wants it, and unharmed."""
        observer, placed = self._opened.observer, self._opened.placed
        if observer.damaged():
            return False
        things = [thing for thing in placed.objects if not thing.fixed]
        assert self._task is not None
        if self._task.kind == "clear":
            return all(observer.in_bin(thing.id) for thing in things)
        # The most robust thing stands rightmost, where y is smallest (benchmark section 3).
        order = sorted(things, key=lambda thing: -thing.affordance.fragility)
        return observer.in_lanes([thing.id for thing in order])

    def _observation(self) -> Observation:
        robot = self._opened.robot
        found: Observation = {}
        for view in robot.look(self.np_random):
            found[f"{view.name}_rgb"] = view.rgb
            found[f"{view.name}_depth"] = view.depth
            found[f"{view.name}_pose"] = np.asarray(view.transform_camera_to_world, float)
        found["joints"] = np.asarray(robot.joints, float)
        found["opening"] = np.array([robot.aperture])
        self._front = found["front_rgb"]
        return found

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override]
        """The front camera's last picture, if the mode is "rgb_array"."""
        return self._front if self.render_mode == "rgb_array" else None


def grasp_of(numbers: Array) -> Grasp:
    """The grasp of eight numbers in the units of `GRASP_LOW`; short things are pinched, low approaches are from the side."""
    x, y, z, tilt, heading, yaw, aperture, force = (float(value) for value in numbers)
    approach = (math.sin(tilt) * math.cos(heading), math.sin(tilt) * math.sin(heading), -math.cos(tilt))
    return Grasp(
        position=(x, y, z),
        approach=approach,
        yaw=yaw,
        aperture=aperture,
        force=force,
        type="side" if tilt > math.radians(30.0) else "power" if aperture > MAX_APERTURE / 2 else "pinch",
    )


def environment_name(scene: str) -> str:
    """Id of a scene's environment: `cup_near_vase` -> `AgenticRagVlm/CupNearVase-v0`."""
    return f"{NAMESPACE}/{''.join(word.capitalize() for word in scene.split('_'))}-v0"


def register() -> tuple[str, ...]:
    """Registers an environment for every task that is not registered yet; returns all ids."""
    names: list[str] = []
    for scene in (scene for group in GROUPS.values() for scene in group):
        name = environment_name(scene)
        names.append(name)
        if name not in gymnasium.registry:
            gymnasium.register(name, entry_point="bench.gym_env:GraspEnv", kwargs={"scene": scene})
    return tuple(names)


register()
