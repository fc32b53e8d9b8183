"""Pictures of a world's states for people: by OpenGL where there is one, ray-cast otherwise.

The agent never sees these; its cameras are in `sim.cameras`.
"""

from __future__ import annotations

import logging
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.picture_opengl import NoOpenGLError, OpenGLPainter
from sim.picture_rays import DRAFT, FINE, PLAIN, Finish, RayPainter
from sim.placed import PlacedScene
from sim.viewpoint import OVERVIEW, Viewpoint
from sim.visual_model import LARGEST, visual_model

log = logging.getLogger(__name__)

Kind = Literal["opengl", "raycast"]


class PictureMaker:
    """Makes pictures of the states of one scene. Close it, or use it in a `with` statement."""

    def __init__(self, placed: PlacedScene, kind: Kind | None = None) -> None:
        """Compiles the visual model once.

        Args:
            placed: The scene.
            kind: "raycast", "opengl", or None for OpenGL where there is one.

        Raises:
            NoOpenGLError: `kind` is "opengl" and there is none.
        """
        self.model = visual_model(placed)
        self._data = mujoco.MjData(self.model)
        self._gl: OpenGLPainter | None = None
        self._rays: RayPainter | None = None
        if kind != "raycast":
            try:
                self._gl = OpenGLPainter(self.model, *LARGEST)
            except NoOpenGLError as error:
                if kind == "opengl":
                    raise
                log.info("pictures are ray-cast, there is no OpenGL: %s", error)
        if self._gl is None:
            self._rays = RayPainter(self.model)

    @property
    def kind(self) -> Kind:
        """How the pictures are made."""
        return "raycast" if self._gl is None else "opengl"

    def picture(
        self,
        qpos: NDArray[np.float64],
        viewpoint: Viewpoint = OVERVIEW,
        width: int = 960,
        height: int = 540,
        finish: Finish = FINE,
    ) -> NDArray[np.uint8]:
        """The scene with joint positions `qpos` (nq,) of the physical model, shape (height, width, 3).

        `finish` is for ray-cast pictures; OpenGL has one.
        """
        self._data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, self._data)
        mujoco.mj_comPos(self.model, self._data)
        mujoco.mj_camlight(self.model, self._data)
        if self._gl is not None:
            return self._gl.paint(self._data, viewpoint, width, height)
        assert self._rays is not None
        return self._rays.paint(self._data, viewpoint, width, height, finish)

    def close(self) -> None:
        """Frees the OpenGL context or the threads."""
        if self._gl is not None:
            self._gl.close()
        if self._rays is not None:
            self._rays.close()

    def __enter__(self) -> PictureMaker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


__all__ = ["DRAFT", "FINE", "PLAIN", "Kind", "PictureMaker", "Viewpoint"]
