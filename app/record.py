"""Writes a run to a folder: result, steps, camera pictures, scene graph over the picture, forces, a video.

The steps are written while they happen; pictures and video are drawn when the run is over.
"""

from __future__ import annotations

import io
import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from app.files import refuse_unusable_folder, write_atomically
from app.force_trace import ForceTrace

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kb.percept import Percept
    from kb.rgbd import RgbdView
    from kb.run_result import RunResult
    from kb.scene_graph import SceneGraph
    from sim.placed import PlacedScene
    from sim.world import World

RESULT, TRACE, FORCES, PICTURE, VIDEO = "result.json", "trace.jsonl", "forces.json", "picture.png", "video"
CAMERAS = "cameras"
PICTURE_SIZES = {"opengl": (960, 540), "raycast": (640, 360)}
"""Of the last moment [px], by how it is painted: software OpenGL is ten times faster."""
OWN_FILES = frozenset({RESULT, TRACE})
"""By these an earlier record is recognised, which may be written over."""


class RunRecord:
    """A record in the making. Attach it to the world before the run, tell it every step, then finish it."""

    def __init__(self, folder: Path) -> None:
        """Refuses a folder that cannot be used; creates nothing yet.

        Raises:
            BadInputError: not a folder, not empty, or not writable.
        """
        refuse_unusable_folder(folder, where="--record", own_files=OWN_FILES)
        self.folder = folder
        self.sampler: Any = None
        self.forces = ForceTrace()
        self._world: World | None = None
        self._views: Callable[[], tuple[RgbdView, ...]] = tuple
        self._percept: Percept | None = None
        self._target: str | None = None
        self._pictures: list[tuple[str, Callable[[], NDArray[np.uint8]]]] = []
        """Name and maker of each camera picture: drawn when the run is over, so that it costs the run nothing."""

    def begin(self, world: World, views: Callable[[], tuple[RgbdView, ...]]) -> None:
        """Creates the folder, clears an earlier record, and listens to the world.

        Args:
            world: The physical world whose motion is filmed.
            views: Gives the pictures of the last look.
        """
        from sim.video import MotionSampler

        (self.folder / CAMERAS).mkdir(parents=True, exist_ok=True)
        for old in [*self.folder.glob(f"{VIDEO}.*"), *(self.folder / CAMERAS).glob("look_*.png")]:
            old.unlink()
        for name in (RESULT, FORCES, PICTURE):
            (self.folder / name).unlink(missing_ok=True)
        (self.folder / TRACE).write_text("", encoding="utf-8")
        self.sampler = MotionSampler()
        self._world, self._views = world, views
        self.forces.listen_to(world.index.sensors)
        world.recorders += [self.sampler, self.forces]

    def on_step(self, step: Any) -> None:
        """Appends the step to the trace and saves the pictures that belong to it."""
        with (self.folder / TRACE).open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(trace_row(step), sort_keys=True) + "\n")
        if step.kind == "look":
            self._percept = step.percept
            self._keep_look(step.percept)
        elif step.kind == "grounding":
            self._target = step.target
        elif step.kind == "graphed" and self._percept is not None:
            self._keep_graph(self._percept, step.graph)

    def _keep_look(self, percept: Percept) -> None:
        """Colour, depth, and colour with perceived boxes and marks of every camera."""
        from tools.draw_scene_graph import draw_scene_graph

        for view in self._views():
            stem = f"look_{percept.look}_{view.name}"
            self._pictures += [
                (f"{stem}.png", partial(np.asarray, view.rgb)),
                (f"{stem}_depth.png", partial(colour_depth, view.depth)),
                (f"{stem}_marks.png", partial(draw_scene_graph, view, percept)),
            ]

    def _keep_graph(self, percept: Percept, graph: SceneGraph) -> None:
        """The scene graph over the front camera's picture."""
        from tools.draw_scene_graph import draw_scene_graph

        for view in self._views():
            if view.name == "front":
                draw = partial(draw_scene_graph, view, percept, graph, target=self._target)
                self._pictures.append((f"look_{percept.look}_graph.png", draw))

    def finish(self, result: RunResult, progress: Callable[[str], None] = lambda _text: None) -> list[Path]:
        """Writes the result, the forces, the final picture and the video; returns all files of the record.

        Args:
            result: What the run came to.
            progress: Told what is being done, for long work.
        """
        write_atomically(self.folder / RESULT, result_text(result))
        write_atomically(self.folder / FORCES, json.dumps(self.forces.rows()))
        for number, (name, draw) in enumerate(self._pictures, start=1):
            progress(f"drawing camera pictures: {number} of {len(self._pictures)}")
            write_atomically(self.folder / CAMERAS / name, png(draw()))
        if self._world is not None:
            self._paint(self._world.placed, self._world.data.qpos.copy(), progress)
        return sorted(path for path in self.folder.rglob("*") if path.is_file())

    def _paint(self, placed: PlacedScene, qpos: NDArray[np.float64], progress: Callable[[str], None]) -> None:
        """The last state as a picture, and the motion as a video."""
        from sim.picture import PLAIN, PictureMaker
        from sim.video import MAX_FRAMES, SAMPLE_S, SPEED, choose_moments, paint_moments, write_video
        from sim.viewpoint import OVERVIEW

        with PictureMaker(placed) as maker:
            progress("painting the last moment")
            write_atomically(
                self.folder / PICTURE, png(maker.picture(qpos, OVERVIEW, *PICTURE_SIZES[maker.kind], PLAIN))
            )
            moments = choose_moments(self.sampler.moments, MAX_FRAMES[maker.kind])
            if not moments:
                return
            kept = len(moments) / len(self.sampler.moments)
            write_video(
                paint_moments(maker, moments),
                self.folder / VIDEO,
                fps=SPEED / SAMPLE_S * kept,
                progress=lambda done: progress(f"painting the video ({maker.kind}): {done} of {len(moments)} frames"),
            )


def trace_row(step: Any) -> dict[str, Any]:
    """A step as one JSON object with the stage of the loop it belongs to (ledger G1)."""
    row = json.loads(step.model_dump_json())
    role = str(row.get("role") or (row.get("exchange") or {}).get("role"))
    return {"stage": STAGES.get(step.kind, ROLE_STAGES.get(role, 7)), **row}


STAGES = {
    "understood": 0, "look": 1, "grounding": 2, "retrieved": 3, "graphed": 4, "constrained": 5, "planned": 5,
    "thought": 6, "approval": 6, "action": 6, "observation": 7, "reflection": 7, "remembered": 7, "sub_goal": 2,
    "question": 2, "answer": 7, "named": 1,
}  # fmt: skip
"""Kind of step -> stage: 0 instruction, 1 perceive, 2 ground, 3 retrieve, 4 graph, 5 constraints and grasp, 6 act,
7 evaluate and reflect."""


def result_text(result: RunResult) -> str:
    """The result as it stands in files: indented JSON with a final newline."""
    return result.model_dump_json(indent=2) + "\n"


ROLE_STAGES = {"understand": 0, "perceive": 1, "think": 6, "reflect": 7, "answer": 7}
"""What a language model is asked for -> stage."""


def png(picture: NDArray[np.uint8]) -> bytes:
    """A picture (H, W, 3) as PNG."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture)).save(buffer, "PNG", compress_level=4)
    return buffer.getvalue()


def colour_depth(depth: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Depth [m] (H, W) in colour: near is warm, far is cold, black is unmeasured; scaled to the picture's own range."""
    known = depth > 0
    if not known.any():
        return np.zeros((*depth.shape, 3), np.uint8)
    low, high = np.percentile(depth[known], [1, 99])
    share = np.clip((depth - low) / max(high - low, 1e-6), 0, 1)
    # A rainbow of few stops, interpolated: red, orange, yellow, green, blue, dark blue.
    stops = np.array([[180, 20, 30], [240, 130, 40], [250, 220, 80], [80, 190, 120], [50, 110, 200], [30, 30, 110]])
    at = share * (len(stops) - 1)
    colour = np.stack([np.interp(at, np.arange(len(stops)), stops[:, c]) for c in range(3)], axis=-1)
    colour[~known] = 0
    return colour.astype(np.uint8)
