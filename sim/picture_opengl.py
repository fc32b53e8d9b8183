"""Pictures for people by OpenGL, where a software or hardware renderer is installed. Nothing here opens a window."""

from __future__ import annotations

import importlib
import os
import sys
from ctypes.util import find_library
from typing import Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.viewpoint import Viewpoint

Backend = Literal["egl", "osmesa"]
BACKENDS: dict[Backend, str] = {"egl": "EGL", "osmesa": "OSMesa"}
"""Off-screen OpenGL of MuJoCo, EGL (also on machines without a display) and Mesa's OSMesa, and its library."""
MAX_GEOMS = 5000
NEAR, FAR = 0.02, 12.0
"""Clipping distances [m]."""


class NoOpenGLError(Exception):
    """There is no OpenGL to paint with here; the message says what each backend answered."""


def open_context(width: int, height: int) -> tuple[Any, Backend]:
    """An OpenGL context that is current in this thread, and its backend.

    Raises:
        NoOpenGLError: no backend works.
    """
    if sys.platform != "linux":
        raise NoOpenGLError(f"off-screen OpenGL is not used on {sys.platform}")
    wanted = (os.environ.get("RAGVLM_OPENGL") or os.environ.get("MUJOCO_GL", "")).lower()
    answers: list[str] = []
    for backend, library in BACKENDS.items():
        if wanted not in ("", backend):
            continue
        if find_library(library) is None:
            # Not even tried: a failed import of PyOpenGL cannot be taken back and would spoil the next backend.
            answers.append(f"{backend}: there is no lib{library}")
            continue
        try:
            context = importlib.import_module(f"mujoco.{backend}").GLContext(width, height)
            context.make_current()
            return context, backend
        except Exception as error:  # PyOpenGL raises whatever its loader met
            answers.append(f"{backend}: {' '.join(str(error).split())[:120]}")
    raise NoOpenGLError("; ".join(answers) or f"MUJOCO_GL={wanted} is not an off-screen backend")


class OpenGLPainter:
    """Paints states of one compiled model with MuJoCo's renderer."""

    def __init__(self, model: mujoco.MjModel, width: int, height: int) -> None:
        """Opens a context for pictures of up to width x height.

        Raises:
            NoOpenGLError: no backend works.
        """
        self._gl: Any
        self.backend: Backend
        self._gl, self.backend = open_context(width, height)
        self._model = model
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._scene = mujoco.MjvScene(model, MAX_GEOMS)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = (1, 1, 1, 0, 0, 0)
        self._camera = mujoco.MjvCamera()

    def close(self) -> None:
        """Frees the context; must be called, because OSMesa complains at exit otherwise."""
        if self._gl is not None:
            self._context.free()
            self._gl.free()
            self._gl = None

    def paint(self, data: mujoco.MjData, viewpoint: Viewpoint, width: int, height: int) -> NDArray[np.uint8]:
        """One picture of the state in `data`, shape (height, width, 3)."""
        self._gl.make_current()
        visible = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(self._model, data, self._option, None, self._camera, visible, self._scene)
        self._aim(viewpoint)
        self._light(viewpoint)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 1
        self._scene.flags[mujoco.mjtRndFlag.mjRND_FOG] = 1
        self._scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = 0
        rect = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(rect, self._scene, self._context)
        picture = np.zeros((height, width, 3), np.uint8)
        mujoco.mjr_readPixels(picture, None, rect, self._context)
        return picture[::-1].copy()

    def _aim(self, viewpoint: Viewpoint) -> None:
        """Both eyes of the scene's camera at the viewpoint: a monocular picture averages them."""
        _, down, forward = viewpoint.axes()
        half = NEAR * np.tan(np.radians(viewpoint.fovy) / 2)
        for eye in self._scene.camera:
            eye.pos[:], eye.forward[:], eye.up[:] = viewpoint.eye, forward, -down
            eye.frustum_near, eye.frustum_far, eye.frustum_center = NEAR, FAR, 0.0
            eye.frustum_bottom, eye.frustum_top = -half, half
            # A width of zero lets the renderer follow the picture's shape.
            eye.frustum_width = 0.0

    def _light(self, viewpoint: Viewpoint) -> None:
        """A soft headlight and one lamp above the viewer's left shoulder that casts shadows."""
        right, _, forward = viewpoint.axes()
        target = np.asarray(viewpoint.target)
        lamp = target - forward * (1, 1, 0) - 1.35 * right + np.array([0.0, 0.0, 2.4])
        lights = self._scene.lights
        self._scene.nlight = 2
        head, key = lights[0], lights[1]
        head.ambient[:], head.diffuse[:], head.specular[:] = 0.42, 0.22, 0.05
        key.type = mujoco.mjtLightType.mjLIGHT_SPOT
        key.headlight, key.castshadow = 0, 1
        key.pos[:], key.dir[:] = lamp, (target - lamp) / np.linalg.norm(target - lamp)
        key.ambient[:], key.diffuse[:], key.specular[:] = 0.0, 0.52, 0.25
        key.attenuation[:], key.cutoff, key.exponent = (1, 0, 0), 60.0, 1.0
        key.bulbradius, key.range, key.intensity = 0.1, FAR, 0.0
