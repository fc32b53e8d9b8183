"""Oracle perception: the same percept as the pixel pipeline's, read from the simulator's truth.

It exists to measure everything downstream of perception alone, and whatever it makes carries `perception="oracle"`.
It is the only perceiver that may import the scene's truth; poses come from the world as it is now.
"""

from __future__ import annotations

from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from kb.base import Vec3
from kb.percept import Part, PerceivedObject, Percept, Shape, pack_surface
from kb.rgbd import RgbdView
from kb.vocabulary import ObjectState, PerceptionName
from sim.placed import PlacedObject, PlacedScene
from tools.perceive import PerceiveArgs
from tools.perception.colour import colour_name
from tools.perception.track_ids import track_ids
from tools.perception.upright_box import UprightBox, box_at, smallest_yaw
from tools.sample_object import surface_in_object

Array = NDArray[np.float64]
K = TypeVar("K")
V = TypeVar("V")

POINTS_PER_OBJECT = 1500
"""Surface samples per object before hidden ones are dropped; `pack_surface` keeps at most 600."""

NOWHERE = 1e9
"""Depth of a cell that shows nothing [m]."""
ON_PIXEL = 0.012
"""A pixel belongs to an object if its point is nearer than this to a surface sample [m] (noise plus sample spacing)."""


class TrueWorld(Protocol):
    """What the oracle reads: the placed scene, and MuJoCo's data with one body per object id."""

    @property
    def placed(self) -> PlacedScene: ...

    @property
    def data(self) -> Any: ...


class Embeds(Protocol):
    """The embedder's one method."""

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None
    ) -> NDArray[Any]: ...


class OraclePerceiver:
    """Reports every object of the world exactly as it is."""

    name: PerceptionName = "oracle"

    def __init__(self, world: TrueWorld, embedder: Embeds | None = None, points: int = POINTS_PER_OBJECT) -> None:
        self._world = world
        self._embedder = embedder
        self._shapes = {obj.id: surface_in_object(obj, points) for obj in world.placed.objects if not obj.fixed}
        self._boxes: dict[tuple[str, bytes], UprightBox] = {}
        self._seen: dict[bytes, tuple[tuple[RgbdView, ...], list[PerceivedObject]]] = {}

    def surfaces(self) -> dict[str, Array]:
        """Samples of each object's true surface now (N, 3), world frame, by scene id."""
        poses = {key: self._pose(key) for key in self._shapes}
        return {key: shape @ poses[key][1].T + poses[key][0] for key, shape in self._shapes.items()}

    def perceive(self, views: tuple[RgbdView, ...], args: PerceiveArgs) -> Percept:
        """All free objects of the world; `views` serve the visual embedding and the visible fraction only."""
        placed = [obj for obj in self._world.placed.objects if not obj.fixed]
        poses = {obj.id: self._pose(obj.id) for obj in placed}
        seen = self._described(placed, poses, views)
        return Percept(look=args.look, perception="oracle", objects=track_ids(seen, args.previous))

    def _described(
        self, placed: list[PlacedObject], poses: dict[str, tuple[Array, Array]], views: tuple[RgbdView, ...]
    ) -> list[PerceivedObject]:
        """All objects; without an embedder the same poses in the same views give the same, so that it is kept."""
        key = b"".join(value.tobytes() for pose in poses.values() for value in pose)
        known = self._seen.get(key)
        if known is not None and known[0] is views:
            return known[1]
        surfaces = self.surfaces()
        boxes = {obj.id: self._box(obj, surfaces[obj.id], poses[obj.id]) for obj in placed}
        seen = [self._describe(obj, poses[obj.id], surfaces, boxes, views) for obj in placed]
        if self._embedder is None:
            _keep(self._seen, key, (views, seen))
        return seen

    def _box(self, obj: PlacedObject, surface_w: Array, pose: tuple[Array, Array]) -> UprightBox:
        """`true_box`, kept while the object stands where it stood."""
        key = obj.id, pose[0].tobytes() + pose[1].tobytes()
        known = self._boxes.get(key)
        return _keep(self._boxes, key, true_box(obj, surface_w, pose[1])) if known is None else known

    def _pose(self, object_id: str) -> tuple[Array, Array]:
        """True position (3,) [m] and rotation object-to-world (3, 3) now."""
        body = self._world.data.body(object_id)
        return np.array(body.xpos, float), np.array(body.xmat, float).reshape(3, 3)

    def _describe(
        self,
        obj: PlacedObject,
        pose: tuple[Array, Array],
        surfaces: dict[str, Array],
        boxes: dict[str, UprightBox],
        views: tuple[RgbdView, ...],
    ) -> PerceivedObject:
        box, surface = boxes[obj.id], surfaces[obj.id]
        others = np.concatenate([s for key, s in surfaces.items() if key != obj.id] or [np.empty((0, 3))])
        position = _vec(box.centre)
        colour = _vec(np.asarray(max(obj.geoms, key=lambda geom: geom.mass).rgba[:3]))
        front = next((view for view in views if view.name == "front"), None)
        return PerceivedObject(
            id=obj.id,
            category=obj.category,
            confidence=1.0,
            posterior={obj.category: 1.0},
            position=position,
            yaw=box.yaw,
            size=_vec(box.size),
            shape=_shape_of(obj, box),
            affordance=obj.affordance,
            state=self._state(obj, box, boxes),
            transparent=obj.transparent,
            colour=colour,
            colour_name=colour_name(colour),
            mass=(obj.mass, obj.mass),
            friction=(obj.friction, obj.friction),
            parts=tuple(_move_part(part, *pose) for part in obj.parts),
            visible_fraction=1.0 if front is None else _visible_fraction(surface, others, front),
            embedding=self._embed(surface, views),
            surface=pack_surface(surface[_outside_first(surface, box)], position),
        )

    def _state(self, obj: PlacedObject, box: UprightBox, boxes: dict[str, UprightBox]) -> ObjectState:
        """Stacked if it rests on or in another object now; filled if it was filled and still stands."""
        base = box.centre[2] - box.size[2] / 2
        for other_id, other in boxes.items():
            top = other.centre[2] + other.size[2] / 2
            above = np.all(np.abs(other.local(box.centre[None])[0, :2]) <= other.size[:2] / 2 + 0.005)
            higher = box.centre[2] > other.centre[2] and base > other.centre[2] - other.size[2] / 2 + 0.002
            if other_id != obj.id and above and higher and 0.005 < base < top + 0.01:
                return "stacked"
        upright = self._pose(obj.id)[1][2, 2] > 0.7
        return "filled" if obj.state == "filled" and upright else "empty"

    def _embed(self, surface: Array, views: tuple[RgbdView, ...]) -> tuple[float, ...]:
        front = next((view for view in views if view.name == "front"), None)
        if self._embedder is None or front is None:
            return ()
        mask = _mask(surface, front)
        if not mask.any():
            return ()
        return tuple(float(value) for value in self._embedder.embed(front.rgb, mask, front.depth))


KEPT = 64
"""Looks, and boxes of objects, that are kept."""


def _keep(known: dict[K, V], key: K, value: V) -> V:
    """Keeps a value in place of the oldest one."""
    while len(known) >= KEPT:
        known.pop(next(iter(known)))
    known[key] = value
    return value


def true_box(obj: PlacedObject, surface_w: Array, rotation: Array) -> UprightBox:
    """The upright box of an object from its true surface (N, 3), world frame.

    The object's own axis counts where its box is within 15 % of the smallest: round things have no other yaw, and a cup's
    smallest box stands askew to its handle.
    """
    own = box_at(surface_w, float(np.arctan2(rotation[1, 0], rotation[0, 0])))
    if np.hypot(rotation[0, 0], rotation[1, 0]) > 0.9 and own.size[0] * own.size[1] > 0:
        yaw, area = smallest_yaw(surface_w)
        return own if own.size[0] * own.size[1] <= 1.15 * area else box_at(surface_w, yaw)
    return box_at(surface_w, smallest_yaw(surface_w)[0])


def _outside_first(surface: Array, box: UprightBox) -> NDArray[np.intp]:
    """Indices of the points that some look from above or from a side could show: all but the underside."""
    return np.flatnonzero(surface[:, 2] > box.centre[2] - box.size[2] / 2 + 0.002)


def _shape_of(obj: PlacedObject, box: UprightBox) -> Shape:
    """Coarse family from the true pieces and extents."""
    kinds = {geom.type for geom in obj.geoms}
    longer, shorter, height = box.size
    regions = {part.region for part in obj.parts}
    if kinds == {"sphere"}:
        return "sphere"
    if height < 0.25 * shorter and height < 0.03:
        return "plate"
    if longer > 2.5 * shorter and height < 0.5 * longer:
        return "bar"
    if len(obj.geoms) == 1 and kinds <= {"box", "cylinder"}:
        return "box" if kinds == {"box"} else "cylinder"
    if "rim" in regions and height < 0.8 * shorter:
        return "bowl"
    return "compound"


def _move_part(part: Part, position: Array, rotation: Array) -> Part:
    """A part of the object's frame in the world frame."""
    turned = None if part.outward is None else _vec(rotation @ np.asarray(part.outward))
    return part.model_copy(
        update={
            "centre": _vec(rotation @ np.asarray(part.centre) + position),
            "axis": _vec(rotation @ np.asarray(part.axis)),
            "outward": turned,
        }
    )


def project(points: Array, view: RgbdView) -> tuple[NDArray[np.intp], NDArray[np.intp], Array, NDArray[np.bool_]]:
    """Pixel column and row, depth [m] and whether inside the picture, of world points (N, 3)."""
    pose = view.transform_camera_to_world
    camera = (points - pose[:3, 3]) @ pose[:3, :3]
    z = np.maximum(camera[:, 2], 1e-6)
    cx, cy = view.centre
    u = np.rint(camera[:, 0] / z * view.focal + cx).astype(np.intp)
    v = np.rint(camera[:, 1] / z * view.focal + cy).astype(np.intp)
    height, width = view.depth.shape
    return u, v, z, (u >= 0) & (u < width) & (v >= 0) & (v < height) & (camera[:, 2] > 0)


def _visible_fraction(surface: Array, others: Array, view: RgbdView, cell: int = 6) -> float:
    """Share of the object's silhouette, in cells of `cell` pixels, that no other object hides."""
    height, width = view.depth.shape
    columns = width // cell + 1
    nearest: list[Array] = []
    for cloud in (surface, others):
        u, v, z, ok = project(cloud, view)
        depth = np.full((height // cell + 1) * columns, NOWHERE)
        np.minimum.at(depth, v[ok] // cell * columns + u[ok] // cell, z[ok])
        nearest.append(depth)
    mine, theirs = nearest
    seen = mine < NOWHERE
    if not seen.any():
        return 0.0
    hidden = seen & (theirs < mine - 0.005)
    return 1.0 - int(hidden.sum()) / int(seen.sum())


def _mask(surface: Array, view: RgbdView) -> NDArray[np.bool_]:
    """Pixels whose measured point lies on the object: cells of samples with a like depth."""
    mask = np.zeros(view.depth.shape, bool)
    u, v, z, ok = project(surface, view)
    height, width = view.depth.shape
    for du in range(-2, 3):
        for dv in range(-2, 3):
            x, y = np.clip(u[ok] + du, 0, width - 1), np.clip(v[ok] + dv, 0, height - 1)
            mask[y, x] |= np.abs(view.depth[y, x] - z[ok]) < ON_PIXEL
    return mask


def _vec(values: NDArray[Any]) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
