"""Opens a scene as a physical world with a robot in it and an observer beside it.

The agent gets from here only the robot and opaque bytes: what the world or the observer is like inside is not its
business. `placed` and `world` are for the faces and the benchmark (pictures, videos, reports), never for tools or nodes.
"""

from __future__ import annotations

import dataclasses
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from kb.errors import BadInputError
from kb.vocabulary import EvaluatorName, PerceptionName

if TYPE_CHECKING:
    from sim.placed import PlacedScene

EVALUATORS: tuple[EvaluatorName, ...] = ("mujoco", "analytic")
PERCEPTIONS: tuple[PerceptionName, ...] = ("rgbd", "oracle", "vlm")


@dataclass
class OpenedWorld:
    """A world that is running: the robot to act with, and the observer that judges afterwards."""

    scene: str
    """Name of the scene."""
    seed: int
    evaluator: EvaluatorName
    robot: Any
    """`sim.robot.Robot` (or the analytic one): sensing and acting."""
    observer: Any
    """`sim.observer.Observer`: asked by `agent.run_result` after the graph has ended, by nobody before."""
    placed: PlacedScene
    """The truth; for faces and benchmark only."""
    world: Any
    """The physical truth; for pictures and videos only."""
    stop: Any
    """Latching stop switch of the robot."""
    reopen: Callable[[], OpenedWorld] = field(repr=False)
    """Opens another world of the same scene and seed, for simulating what would have happened."""

    @property
    def motions(self) -> int:
        """Number of motions begun so far; tells recordings apart."""
        return int(self.world.attempt)

    def snapshot(self) -> bytes:
        """The whole physical state and what the observer has recorded, as opaque bytes."""
        physics, observed = self.world.snapshot(), self.observer.state()
        return packed(self.motions, physics, observed)

    def restore(self, blob: bytes) -> None:
        """Continues exactly where `snapshot` was taken, bit for bit."""
        raw = zlib.decompress(blob)
        motions, length = struct.unpack_from("<qq", raw)
        self.world.restore(raw[16 : 16 + length])
        self.world.attempt = motions
        if len(raw) > 16 + length:
            self.observer.load(raw[16 + length :])

    def forget(self, keep: int = 0) -> None:
        """Lets the observer forget all but the last `keep` motions."""
        self.observer.forget(keep)

    @staticmethod
    def physics_of(blob: bytes) -> bytes:
        """The snapshot without what the observer has recorded: enough to simulate from, and small."""
        raw = zlib.decompress(blob)
        _, length = struct.unpack_from("<qq", raw)
        return zlib.compress(raw[: 16 + length], level=1)


def packed(motions: int, physics: bytes, observed: bytes = b"") -> bytes:
    """A snapshot of a physical state after so many motions, with what the observer recorded."""
    return zlib.compress(struct.pack("<qq", motions, len(physics)) + physics + observed, level=1)


def open_world(
    scene: str,
    seed: int,
    *,
    evaluator: EvaluatorName = "mujoco",
    noise: float = 1.0,
    change: Callable[[PlacedScene], PlacedScene] | None = None,
) -> OpenedWorld:
    """Draws the scene with its seed, compiles it, and puts the robot and the observer in.

    Args:
        scene: built-in name or path of a scene file.
        seed: everything random in the world follows from it.
        evaluator: "mujoco" for contact physics, "analytic" for the paper's kind of simulation.
        noise: scale of the uncertainties: camera noise and calibration, friction and mass.
        change: what is made of the drawn scene before it is compiled; the agent is told nothing of it.

    Raises:
        BadInputError: unknown scene, evaluator, or a scene file that is not valid.
    """
    if evaluator not in EVALUATORS:
        raise BadInputError(f"unknown evaluator {evaluator!r}", choices=EVALUATORS)
    from sim.draw_scene import draw_scene
    from sim.observer import Observer
    from sim.scene_file import load_scene
    from sim.stop import StopSwitch
    from sim.world import World

    spec = load_scene(scene)
    placed = dataclasses.replace(draw_scene(spec, seed, noise=noise), noise=noise)
    placed = placed if change is None else change(placed)
    world, stop = World(placed), StopSwitch()
    if evaluator == "analytic":
        from sim.analytic import AnalyticRobot
        from sim.analytic_observer import AnalyticObserver

        robot: Any = AnalyticRobot(world, stop=stop)
        observer: Any = AnalyticObserver(world)
    else:
        from sim.robot import Robot

        robot, observer = Robot(world, stop=stop), Observer(world)
    return OpenedWorld(
        scene=placed.name,
        seed=seed,
        evaluator=evaluator,
        robot=robot,
        observer=observer,
        placed=placed,
        world=world,
        stop=stop,
        reopen=lambda: open_world(scene, seed, evaluator=evaluator, noise=noise, change=change),
    )


def open_perceiver(name: PerceptionName, opened: OpenedWorld, embedder: Any) -> Any:
    """The perceiver of that name; only "oracle" is shown the truth, and labels every percept so.

    Raises:
        BadInputError: unknown name.
    """
    if name in ("rgbd", "vlm"):  # "vlm" measures the same way; the brain names afterwards (`tools.name_objects`)
        from tools.perception import RgbdPerceiver

        return RgbdPerceiver(embedder)
    if name == "oracle":
        from tools.oracle_perception import OraclePerceiver

        oracle = OraclePerceiver(opened.world, embedder)
        if opened.evaluator == "analytic":
            from tools.noisy_oracle import NoisyOracle

            return NoisyOracle(oracle, opened.seed)
        return oracle
    raise BadInputError(f"unknown perception {name!r}", choices=PERCEPTIONS)
