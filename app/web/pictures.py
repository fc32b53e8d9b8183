"""The robot's camera pictures with what it perceived drawn on them: boxes, part marks, the scene graph.

Drawn in a thread of their own, so that neither the robot nor the server waits; the last few are kept in memory.
"""

from __future__ import annotations

import io
import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from kb.percept import Percept
    from kb.rgbd import RgbdView
    from kb.scene_graph import SceneGraph

KEPT = 16
SCALE = 2
"""Enlargement of the camera's picture, so that labels are readable."""
LEAST_SHARE = 0.34
"""Smallest part of a picture that is shown by itself."""
SIZE = (960, 720)
"""Of a picture on the page [px]."""


class Pictures:
    """Draws on request and keeps the latest."""

    def __init__(self, ready: Callable[[dict[str, str]], None]) -> None:
        """Args: who is told the paths of the latest pictures, by camera."""
        self._ready = ready
        self._kept: OrderedDict[str, bytes] = OrderedDict()
        self._lock = threading.Lock()
        self._number = 0
        self._views: tuple[RgbdView, ...] = ()
        self._percept: Percept | None = None
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="ragvlm-pictures")

    def look(self, views: tuple[RgbdView, ...], percept: Percept | None) -> None:
        """A new look: its pictures, with what was perceived (plain without a percept)."""
        self._views, self._percept = views, percept
        self._submit(None, None)

    def relate(self, graph: SceneGraph, target: str | None) -> None:
        """The scene graph of the last look, and which object is meant."""
        if self._percept is not None:
            self._submit(graph, target)

    def _submit(self, graph: SceneGraph | None, target: str | None) -> None:
        """A later call that comes before this one's turn replaces it."""
        self._number += 1
        if self._views:
            self._pool.submit(self._draw, self._number, self._views, self._percept, graph, target)

    def get(self, name: str) -> bytes | None:
        """The JPEG of that name, if it is still kept."""
        with self._lock:
            return self._kept.get(name)

    def close(self) -> None:
        """Draws nothing more."""
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _draw(
        self,
        number: int,
        views: tuple[RgbdView, ...],
        percept: Percept | None,
        graph: SceneGraph | None,
        target: str | None,
    ) -> None:
        if number != self._number:
            return
        names: dict[str, str] = {}
        for view in views:
            whole = view.rgb if percept is None else annotated(view, percept, graph, target)
            near = whole if percept is None else whole[cut_out(view, percept)]
            names[view.name] = self._keep(f"{number}-{view.name}.jpg", whole)
            names[f"{view.name}/near"] = self._keep(f"{number}-{view.name}-near.jpg", near)
        self._ready(names)

    def _keep(self, name: str, picture: NDArray[np.uint8]) -> str:
        """The path under which the picture can be had."""
        data = jpeg(picture)
        with self._lock:
            self._kept[name] = data
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return f"/pictures/{name}"


def cut_out(view: RgbdView, percept: Percept) -> tuple[slice, slice]:
    """Rows and columns of the enlarged picture around everything perceived, in the picture's own shape.

    On a small panel the labels can be read only there.
    """
    import numpy as np

    from tools.draw_scene_graph import box_corners, project

    height, width = view.rgb.shape[0] * SCALE, view.rgb.shape[1] * SCALE
    corners = [project(view, box_corners(thing)) * SCALE for thing in percept.objects]
    found = np.concatenate(corners) if corners else np.zeros((0, 2))
    found = found[np.isfinite(found).all(axis=1)]
    if not len(found):
        return slice(0, height), slice(0, width)
    low, high = found.min(axis=0), found.max(axis=0)
    share = float(np.clip(((high - low) / (width, height)).max() * 1.5 + 0.08, LEAST_SHARE, 1.0))
    size = np.array([width, height]) * share
    start = np.clip((low + high) / 2 - size / 2, 0, np.array([width, height]) - size).astype(int)
    stop = start + size.astype(int)
    return slice(start[1], stop[1]), slice(start[0], stop[0])


def annotated(view: RgbdView, percept: Percept, graph: SceneGraph | None, target: str | None) -> NDArray[np.uint8]:
    """The picture with boxes, numbered marks, arrows of the scene graph, and a labelled diamond at each part."""
    import numpy as np
    from PIL import Image, ImageDraw, ImageFont

    from tools.draw_scene_graph import draw_scene_graph, project

    wide = draw_scene_graph(view, percept, graph, target=target, scale=SCALE)
    picture = Image.fromarray(np.ascontiguousarray(wide[:, : view.rgb.shape[1] * SCALE]))
    draw, font = ImageDraw.Draw(picture, "RGBA"), ImageFont.load_default(size=18)
    marks: list[tuple[float, float, str]] = []
    for thing in percept.objects:
        for part in thing.parts:
            x, y = project(view, np.array([part.centre]))[0] * SCALE
            if part.region != "body" and np.isfinite(x) and 0 <= x < picture.width and 0 <= y < picture.height:
                marks.append((float(x), float(y), part.region))
    for x, y, _ in marks:
        draw.polygon([(x, y - 9), (x + 9, y), (x, y + 9), (x - 9, y)], fill=(255, 255, 255, 230), outline=(0, 0, 0))
    taken = [(x - 9, y - 9, x + 9, y + 9) for x, y, _ in marks]
    for x, y, region in marks:
        box = _free(draw.textbbox((x + 22, y), region, font=font, anchor="lm"), taken)
        taken.append(box)
        draw.rounded_rectangle((box[0] - 4, box[1] - 3, box[2] + 4, box[3] + 3), 4, fill=(255, 255, 255, 225))
        draw.text((box[0], (box[1] + box[3]) / 2), region, font=font, anchor="lm", fill=(20, 20, 20))
    return np.asarray(picture)


def _free(box: tuple[float, float, float, float], taken: list[tuple[float, float, float, float]]) -> Any:
    """The label's box, moved up until it covers no earlier label."""
    left, top, right, bottom = box
    while any(left < t[2] + 8 and t[0] < right + 8 and top < t[3] + 6 and t[1] < bottom + 6 for t in taken):
        top, bottom = top - 8, bottom - 8
    return left, top, right, bottom


def jpeg(picture: NDArray[np.uint8]) -> bytes:
    """A picture (H, W, 3) as JPEG of at most `SIZE`."""
    from PIL import Image

    image = Image.fromarray(picture)
    image.thumbnail(SIZE)
    buffer = io.BytesIO()
    image.save(buffer, "JPEG", quality=86)
    return buffer.getvalue()
