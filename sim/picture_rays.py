"""Pictures for people, ray-cast by MuJoCo and shaded here: soft shadows, sky light, glass; no OpenGL, no system package.

Knows nothing of robots or scenes: it paints any compiled model. Colours are linear inside and sRGB in the result.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.picture_studio import backdrop, dome, grain, key_points, linear_rgb
from sim.viewpoint import Viewpoint

Array = NDArray[np.float32]

NOTHING, FLOOR = -1, -2
"""In place of a geom id: the ray met nothing, or the studio floor."""
SEEN = np.array([1, 1, 1, 0, 0, 0], np.uint8)
"""Geom groups that are painted: setting, objects and visual meshes; not the robot's collision shapes."""
FAR = 12.0
"""Nothing further away than this is painted [m]."""
SKIN = 1.5e-3
"""Shadow rays may end this much before the surface they light [m]: below the thinnest wall (a cup's 4 mm)."""
BLOCK = 60_000
"""Rays cast at once, so that the work divides over threads and memory stays small."""


@dataclass(frozen=True)
class Finish:
    """How much care a picture gets."""

    key_rays: int
    """Points on the key light; one gives hard shadows."""
    sky_rays: int
    """Points on the sky dome that cast shadows; zero lights evenly."""
    smooth_edges: bool
    """Cast four more rays in pixels where the picture changes abruptly."""
    grain: bool
    """Draw the grain of the table's wood."""


DRAFT = Finish(key_rays=1, sky_rays=0, smooth_edges=False, grain=True)
"""For videos: about one second a megapixel."""
PLAIN = Finish(key_rays=2, sky_rays=3, smooth_edges=True, grain=True)
"""For the pictures of a record: about ten seconds a megapixel on one core."""
FINE = Finish(key_rays=4, sky_rays=6, smooth_edges=True, grain=True)
"""For single pictures: seconds."""
SHOWPIECE = Finish(key_rays=24, sky_rays=48, smooth_edges=True, grain=True)
"""For the picture on the front page."""


@dataclass(frozen=True)
class _Hits:
    """What a bundle of rays met. All arrays have one row per ray."""

    geom: NDArray[np.int32]
    """Geom id, or `NOTHING` or `FLOOR`."""
    point: Array
    normal: Array
    distance: Array


class RayPainter:
    """Paints states of one compiled model."""

    def __init__(self, model: mujoco.MjModel, *, threads: int = 2) -> None:
        """Args: the model to paint, of which geoms in groups 0 to 2 are seen; number of threads that cast rays."""
        self._model = model
        self._solid = _copy_without_glass(model)
        self._threads = max(1, threads)
        self._pool = ThreadPoolExecutor(self._threads)
        # Casting uses the scratch stack of its data, so that every thread needs its own.
        self._data = [mujoco.MjData(model) for _ in range(self._threads)]
        self._albedo = _linear(model.geom_rgba[:, :3])
        self._alpha = model.geom_rgba[:, 3].astype(np.float32)
        self._table, self._floor = (mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, n) for n in ("table", "floor"))

    def close(self) -> None:
        """Ends the threads."""
        self._pool.shutdown()

    def paint(
        self, data: mujoco.MjData, viewpoint: Viewpoint, width: int, height: int, finish: Finish = FINE
    ) -> NDArray[np.uint8]:
        """One picture of the state in `data`, shape (height, width, 3). Deterministic."""
        for own in self._data:
            own.geom_xpos[:], own.geom_xmat[:] = data.geom_xpos, data.geom_xmat
            own.xpos[:], own.xmat[:] = data.xpos, data.xmat
            own.xipos[:], own.ximat[:] = data.xipos, data.ximat
        rows, columns = np.mgrid[0:height, 0:width]
        pixels = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(np.float64)
        colour, geom = self._look(viewpoint, pixels, width, height, finish)
        if finish.smooth_edges:
            edge = _edges(colour.reshape(height, width, 3), geom.reshape(height, width)).ravel()
            total = colour[edge].copy()
            for shift in ((-0.375, -0.125), (0.125, -0.375), (0.375, 0.125), (-0.125, 0.375)):
                total += self._look(viewpoint, pixels[edge] + shift, width, height, finish)[0]
            colour[edge] = total / 5
        return _display(colour).reshape(height, width, 3)

    def _look(
        self, viewpoint: Viewpoint, pixels: NDArray[np.float64], width: int, height: int, finish: Finish
    ) -> tuple[Array, NDArray[np.int32]]:
        """Colours (N, 3), tone-mapped, and geom ids (N,) of pixels (N, 2)."""
        rays = viewpoint.rays(pixels, width, height)
        eye = np.asarray(viewpoint.eye, np.float64)
        hits = self._cast(self._model, eye, rays)
        colour = self._shade(hits, rays, viewpoint, finish)
        glass = np.flatnonzero((hits.geom >= 0) & (self._alpha[np.maximum(hits.geom, 0)] < 1.0))
        if glass.size:
            behind = self._cast(self._solid, eye, rays[glass])
            through = self._shade(behind, rays[glass], viewpoint, finish)
            colour[glass] = self._glaze(hits, glass, rays, colour[glass], through)
        return _tone(colour), hits.geom

    def _glaze(
        self, hits: _Hits, glass: NDArray[np.int64], rays: NDArray[np.float64], own: Array, through: Array
    ) -> Array:
        """Glass: what is behind it, tinted, and more of its own colour where it is seen at a slant (Fresnel)."""
        cosine = np.abs(np.einsum("ij,ij->i", hits.normal[glass], rays[glass].astype(np.float32)))
        alpha = self._alpha[hits.geom[glass]]
        opacity = np.clip(alpha * 0.8 + 0.6 * (1.0 - cosine) ** 2.5, 0, 1)[:, None]
        tint = 0.35 + 0.65 * self._albedo[hits.geom[glass]]
        return own * opacity + through * tint * (1.0 - opacity)

    def _cast(self, model: mujoco.MjModel, eye: NDArray[np.float64], rays: NDArray[np.float64]) -> _Hits:
        """First hits of unit `rays` (N, 3) from `eye` (3,)."""
        geom, distance, normal = self._multi_ray(model, eye, rays)
        reach = np.where(geom == NOTHING, FAR, distance)
        point = eye + rays * reach[:, None]
        # Thin shells are seen from inside too (a cup): their normal is turned towards the eye.
        facing = np.einsum("ij,ij->i", normal, rays) > 0
        normal[facing] *= -1.0
        return _Hits(geom, point.astype(np.float32), normal.astype(np.float32), reach.astype(np.float32))

    def _multi_ray(
        self, model: mujoco.MjModel, origin: NDArray[np.float64], rays: NDArray[np.float64]
    ) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]:
        """Geom id (N,), distance (N,) and normal (N, 3) of the nearest geom on each ray, cast in threads."""
        count = len(rays)
        geom, distance = np.full(count, -1, np.int32), np.zeros(count)
        normal = np.zeros((count, 3))

        def work(thread: int) -> None:
            for start in range(thread * BLOCK, count, BLOCK * self._threads):
                part = slice(start, min(start + BLOCK, count))
                flat = np.zeros(3 * (part.stop - part.start))
                mujoco.mj_multiRay(
                    model, self._data[thread], origin, rays[part].ravel(), SEEN, True, -1,
                    geom[part], distance[part], flat, part.stop - part.start, FAR,
                )  # fmt: skip
                normal[part] = flat.reshape(-1, 3)

        list(self._pool.map(work, range(self._threads)))
        if self._floor >= 0:
            geom[geom == self._floor] = FLOOR
        return geom, distance, normal

    def _shade(self, hits: _Hits, rays: NDArray[np.float64], viewpoint: Viewpoint, finish: Finish) -> Array:
        """Linear colours (N, 3) of hits."""
        behind = backdrop(rays)
        colour = behind.copy()
        lit = np.flatnonzero(hits.geom != NOTHING)
        if not lit.size:
            return colour
        point, normal, geom = hits.point[lit], hits.normal[lit], hits.geom[lit]
        albedo = np.where((geom == FLOOR)[:, None], linear_rgb(0.46, 0.49, 0.53), self._albedo[np.maximum(geom, 0)])
        if finish.grain and self._table >= 0:
            wood = (geom == self._table) & (normal[:, 2] > 0.9)
            albedo[wood] *= grain(point[wood])[:, None]
        view = -rays[lit].astype(np.float32)
        diffuse, gloss = self._light(point, normal, view, viewpoint, finish)
        shine = np.where(geom == FLOOR, 0.0, 0.22).astype(np.float32)
        rim = (1.0 - np.clip(np.einsum("ij,ij->i", normal, view), 0, 1)) ** 4 * shine
        shaded = albedo * diffuse + (gloss * shine + 0.35 * rim)[:, None]
        # The studio floor fades into the backdrop, so that it has no horizon.
        away = np.linalg.norm(point[:, :2] - np.array(viewpoint.target[:2], np.float32), axis=1)
        fade = np.where(geom == FLOOR, np.clip((away - 0.9) / 2.6, 0, 1), 0.0).astype(np.float32)[:, None]
        colour[lit] = shaded * (1 - fade) + behind[lit] * fade
        return colour

    def _light(
        self, point: Array, normal: Array, view: Array, viewpoint: Viewpoint, finish: Finish
    ) -> tuple[Array, Array]:
        """Light that arrives (N, 3) and the highlight of the key light (N,)."""
        target = np.asarray(viewpoint.target, np.float64)
        key = key_points(target, viewpoint, finish.key_rays)
        diffuse = np.zeros_like(point)
        gloss: Array = np.zeros(len(point), np.float32)
        warm = linear_rgb(1.0, 0.965, 0.91) * 1.95
        for lamp in key:
            share, towards = self._arrives(lamp, point, normal)
            diffuse += share[:, None] * warm / len(key)
            half = towards + view
            half /= np.linalg.norm(half, axis=1, keepdims=True) + 1e-9
            gloss += (share > 0) * np.clip(np.einsum("ij,ij->i", normal, half), 0, 1) ** 60 / len(key)
        up = 0.5 + 0.5 * normal[:, 2:3]
        sky, ground = linear_rgb(0.80, 0.90, 1.05), linear_rgb(0.50, 0.47, 0.44)
        if finish.sky_rays == 0:
            return (diffuse + 0.62 * (sky * up + ground * (1 - up))).astype(np.float32), gloss
        sky_points = dome(target, finish.sky_rays)
        open_sky = np.zeros(len(point), np.float32)
        for lamp in sky_points:
            open_sky += self._arrives(lamp, point, normal)[0]
        diffuse += open_sky[:, None] * sky * (1.15 / len(sky_points)) + 0.22 * (sky * up + 1.3 * ground * (1 - up))
        return diffuse.astype(np.float32), gloss

    def _arrives(self, lamp: NDArray[np.float64], point: Array, normal: Array) -> tuple[Array, Array]:
        """Cosine-weighted light of one lamp (3,) at points (N, 3), zero in shadow, and the directions to it (N, 3)."""
        towards = lamp.astype(np.float32) - point
        length = np.linalg.norm(towards, axis=1)
        towards /= length[:, None]
        share = np.clip(np.einsum("ij,ij->i", normal, towards), 0, None).astype(np.float32)
        front = np.flatnonzero(share > 0)
        geom, distance, _ = self._multi_ray(self._model, lamp, -towards[front].astype(np.float64))
        blocked = (geom != NOTHING) & (distance < length[front] - SKIN)
        # Glass throws a faint shadow only.
        passes = np.where(blocked, 0.7 * (self._alpha[np.maximum(geom, 0)] < 1.0), 1.0)
        share[front] *= passes.astype(np.float32)
        return share, towards


def _copy_without_glass(model: mujoco.MjModel) -> mujoco.MjModel:
    """A copy in which transparent geoms are invisible to rays (MuJoCo's rays pass geoms of zero alpha)."""
    import copy

    solid = copy.copy(model)
    solid.geom_rgba[solid.geom_rgba[:, 3] < 1.0, 3] = 0.0
    return solid


def _linear(srgb: NDArray[np.floating]) -> Array:
    return np.power(np.asarray(srgb, np.float32), np.float32(2.2))


def _tone(colour: Array) -> Array:
    """Compresses bright light so that white stays white without burning out (Reinhard's curve with a white point)."""
    exposed = colour * np.float32(0.80)
    return (exposed * (1.0 + exposed / 2.6**2) / (1.0 + exposed * 0.55)).astype(np.float32)


def _display(colour: Array) -> NDArray[np.uint8]:
    return (np.power(np.clip(colour, 0, 1), np.float32(1 / 2.2)) * 255 + 0.5).astype(np.uint8)


def _edges(colour: Array, geom: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pixels whose neighbour shows another geom or a clearly different colour, (H, W)."""
    edge = np.zeros(geom.shape, bool)
    for axis in (0, 1):
        jump = (np.diff(geom, axis=axis) != 0) | (np.abs(np.diff(colour, axis=axis)).max(axis=2) > 0.06)
        low = (slice(None, -1), slice(None)) if axis == 0 else (slice(None), slice(None, -1))
        high = (slice(1, None), slice(None)) if axis == 0 else (slice(None), slice(1, None))
        edge[low] |= jump
        edge[high] |= jump
    return edge
