"""Draws what perception found over a camera picture: boxes, numbered marks, and the scene graph between the marks.

For people (records, documentation) and for models that answer by mark number. Knows nothing of the truth: boxes are the
perceived ones, projected with the pose that the robot was told.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kb.percept import PerceivedObject, Percept
from kb.rgbd import RgbdView
from kb.scene_graph import SceneEdge, SceneGraph
from kb.vocabulary import INVERSE, Relation

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw

Box = tuple[float, float, float, float]
"""Left, top, right, bottom [px]."""
PALETTE: tuple[tuple[int, int, int], ...] = (
    (31, 119, 180),
    (214, 39, 40),
    (44, 160, 44),
    (148, 103, 189),
    (255, 127, 14),
    (23, 190, 207),
    (188, 60, 140),
    (120, 94, 60),
)
"""Colours of the marks, by number."""
ARROWS: tuple[Relation, ...] = (
    "ON_TOP_OF",
    "CONTAINS",
    "LEANING_ON",
    "OCCLUDES",
    "BLOCKS_APPROACH",
    "TOUCHING",
    "ADJACENT_TO",
)
"""Relations drawn as arrows, the telling ones first; the directional ones hold between almost all pairs and are only
listed."""
BOX_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
BOX_EDGES = [(a, b) for a in range(8) for b in range(a + 1, 8) if bin(a ^ b).count("1") == 1]
PANEL = 430
"""Width of the list beside the picture [px]."""
MARK = 15
"""Radius of a mark [px]."""


def draw_scene_graph(
    view: RgbdView, percept: Percept, graph: SceneGraph | None = None, *, target: str | None = None, scale: int = 2
) -> NDArray[np.uint8]:
    """The camera picture with boxes and marks and, if there is a graph, its edges and a list of all relations.

    Args:
        view: The picture and the pose it was taken from.
        percept: What was perceived in it; mark n is the object "obj_n".
        graph: The scene graph.
        target: Perceived id to be set off as the target.
        scale: Enlargement of the picture, so that labels are readable.

    Returns:
        Picture (H * scale, W * scale [+ the list], 3).
    """
    from PIL import Image, ImageDraw

    picture = Image.fromarray(view.rgb).resize((view.rgb.shape[1] * scale, view.rgb.shape[0] * scale))
    draw = ImageDraw.Draw(picture, "RGBA")
    centres: dict[str, tuple[float, float]] = {}
    for number, thing in enumerate(percept.objects):
        corners = project(view, box_corners(thing)) * scale
        centre = project(view, np.array([thing.position]))[0] * scale
        if not np.isfinite(corners).all() or not np.isfinite(centre).all():
            continue
        centres[thing.id] = (float(centre[0]), float(centre[1]))
        colour = PALETTE[number % len(PALETTE)]
        for a, b in BOX_EDGES:
            ends = [(float(corners[a, 0]), float(corners[a, 1])), (float(corners[b, 0]), float(corners[b, 1]))]
            draw.line(ends, fill=(*colour, 220), width=4 if thing.id == target else 2)
    shown = distinct_edges(graph) if graph is not None else ()
    taken: list[Box] = [(x - MARK, y - MARK, x + MARK, y + MARK) for x, y in centres.values()]
    for (source, other), words in _arrow_labels(shown).items():
        if source in centres and other in centres:
            _arrow(draw, centres[source], centres[other], words, taken)
    for number, thing in enumerate(percept.objects):
        if thing.id in centres:
            _mark(draw, centres[thing.id], thing.id.rsplit("_", 1)[-1], PALETTE[number % len(PALETTE)])
    if graph is None:
        return np.asarray(picture)
    sheet = Image.new("RGB", (picture.width + PANEL, picture.height), (250, 250, 250))
    sheet.paste(picture, (0, 0))
    _list(ImageDraw.Draw(sheet), picture.width + 18, percept, shown, target)
    return np.asarray(sheet)


def box_corners(thing: PerceivedObject) -> NDArray[np.float64]:
    """Corners of the upright oriented bounding box in the world frame [m], (8, 3)."""
    cosine, sine = np.cos(thing.yaw), np.sin(thing.yaw)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return BOX_CORNERS * np.asarray(thing.size) @ turn.T + np.asarray(thing.position)


def project(view: RgbdView, points_w: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pixels (N, 2) of world points (N, 3) [m]; NaN behind the camera."""
    pose = view.transform_camera_to_world
    camera = (points_w - pose[:3, 3]) @ pose[:3, :3]
    depth = np.where(camera[:, 2:] > 1e-6, camera[:, 2:], np.nan)
    return camera[:, :2] / depth * view.focal + np.asarray(view.centre)


def distinct_edges(graph: SceneGraph) -> tuple[SceneEdge, ...]:
    """Edges without those that only say an earlier one the other way round."""
    said: set[tuple[str, Relation, str]] = set()
    kept: list[SceneEdge] = []
    for edge in graph.edges:
        inverse = INVERSE.get(edge.relation)
        if inverse is None or (edge.target, inverse, edge.source) not in said:
            kept.append(edge)
        said.add((edge.source, edge.relation, edge.target))
    return tuple(kept)


def _arrow_labels(edges: tuple[SceneEdge, ...]) -> dict[tuple[str, str], str]:
    """What to write on the arrow of each pair that has one: its most telling relation and the gap."""
    best: dict[tuple[str, str], SceneEdge] = {}
    for edge in sorted((e for e in edges if e.relation in ARROWS), key=lambda e: ARROWS.index(e.relation)):
        best.setdefault((edge.source, edge.target), edge)
    return {
        pair: edge.relation.lower().replace("_", " ") + (f" {edge.gap * 1000:.0f} mm" if edge.gap else "")
        for pair, edge in best.items()
    }


def _arrow(draw: ImageDraw, start: tuple[float, float], end: tuple[float, float], label: str, taken: list[Box]) -> None:
    """An arrow between two marks with its label on it, where no earlier label (`taken`) stands."""
    from PIL import ImageFont

    a, b = np.asarray(start), np.asarray(end)
    length = float(np.linalg.norm(b - a))
    if length < 2.5 * MARK:
        return
    along = (b - a) / length
    across = np.array([-along[1], along[0]])
    tail, head = a + along * MARK, b - along * MARK
    draw.line([tuple(tail), tuple(head)], fill=(255, 255, 255, 230), width=5)
    draw.line([tuple(tail), tuple(head)], fill=(30, 30, 30, 255), width=2)
    wings = [head, head - along * 13 + across * 6, head - along * 13 - across * 6]
    draw.polygon([(float(p[0]), float(p[1])) for p in wings], fill=(30, 30, 30, 255))
    font = ImageFont.load_default(size=15)
    middle = (tail + head) / 2
    places = [middle + along * length * share for share in (0.0, -0.15, 0.15, -0.3, 0.3)]
    places += [middle + across * shift for shift in (-32.0, 32.0, -64.0, 64.0)]
    boxes = [draw.textbbox((float(p[0]), float(p[1])), label, font=font, anchor="mm") for p in places]
    free = next((i for i, box in enumerate(boxes) if not any(_overlap(box, other) for other in taken)), 0)
    box, place = boxes[free], places[free]
    taken.append(box)
    draw.rounded_rectangle((box[0] - 5, box[1] - 3, box[2] + 5, box[3] + 3), 4, fill=(255, 255, 255, 225))
    draw.text((float(place[0]), float(place[1])), label, font=font, anchor="mm", fill=(20, 20, 20, 255))


def _overlap(a: Box, b: Box) -> bool:
    """Whether two boxes (left, top, right, bottom) come within a label's padding of each other."""
    return a[0] - 10 < b[2] and b[0] - 10 < a[2] and a[1] - 6 < b[3] and b[1] - 6 < a[3]


def _mark(draw: ImageDraw, centre: tuple[float, float], text: str, colour: tuple[int, int, int]) -> None:
    """A numbered disc."""
    from PIL import ImageFont

    x, y = centre
    draw.ellipse((x - MARK, y - MARK, x + MARK, y + MARK), fill=(*colour, 235), outline=(255, 255, 255, 255), width=2)
    draw.text((x, y), text, font=ImageFont.load_default(size=17), anchor="mm", fill=(255, 255, 255, 255))


def _list(draw: ImageDraw, left: int, percept: Percept, edges: tuple[SceneEdge, ...], target: str | None) -> None:
    """The objects and all relations as text, from `left` [px] on."""
    from PIL import ImageFont

    head, body = ImageFont.load_default(size=19), ImageFont.load_default(size=15)
    top = 16
    draw.text((left, top), "perceived", font=head, fill=(20, 20, 20))
    top += 30
    for number, thing in enumerate(percept.objects):
        colour = PALETTE[number % len(PALETTE)]
        state = "" if thing.state == "empty" else f", {thing.state}"
        words = f"{thing.id}  {thing.colour_name} {thing.category} ({thing.confidence:.2f}){state}"
        words += "  <- target" if thing.id == target else ""
        draw.text((left, top), words, font=body, fill=colour)
        top += 21
    top += 14
    draw.text((left, top), "relations", font=head, fill=(20, 20, 20))
    top += 30
    for edge in edges:
        gap = "" if edge.gap is None else f"  {edge.gap * 1000:.0f} mm"
        words = f"{edge.source}  {edge.relation}  {edge.target}{gap}"
        draw.text((left, top), words, font=body, fill=(20, 20, 20) if edge.relation in ARROWS else (120, 120, 120))
        top += 20
