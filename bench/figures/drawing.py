"""What the figures have in common: colours, boxes, arrows, and how they are saved. matplotlib loads when one is drawn."""

from __future__ import annotations

import io
import textwrap
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

INK, MUTED, RULE, PAPER, PANEL = "#17191c", "#5b626b", "#c9cfd6", "#ffffff", "#f4f6f8"
BLUE, ORANGE, GREEN, RED, PURPLE = "#0072b2", "#d98a00", "#00805d", "#c8501e", "#8e4a80"
"""Told apart by colour-blind readers as well, and always accompanied by words (after Okabe and Ito)."""
TINTS = {BLUE: "#e3f0f8", ORANGE: "#fcf1dd", GREEN: "#dff3ec", RED: "#fae6de", PURPLE: "#f3e6f0", MUTED: "#eef0f2"}

SMALL, BODY, HEAD, TITLE = 8.5, 9.5, 11.0, 15.0
"""Type sizes [pt]."""
LEADING = 1.42
"""Distance of lines over the type size."""
DPI = 150


def sheet(width: float, height: float) -> tuple[Any, Any]:
    """An empty figure and an axis over all of it whose unit is the inch, y downwards."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=DPI, facecolor=PAPER)
    axis = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axis.set_xlim(0, width)
    axis.set_ylim(height, 0)
    axis.axis("off")
    return figure, axis


def box(
    axis: Any, x: float, y: float, width: float, height: float, colour: str = MUTED, *, fill: str | None = None
) -> None:
    """A rounded box; inches."""
    from matplotlib.patches import FancyBboxPatch

    style = "round,pad=0,rounding_size=0.07"
    axis.add_patch(
        FancyBboxPatch(
            (x, y), width, height, boxstyle=style, linewidth=1.2, edgecolor=colour, facecolor=fill or TINTS[colour]
        )
    )


def words(
    axis: Any, x: float, y: float, text: str, *, size: float = BODY, colour: str = INK, bold: bool = False,
    wrap: int | None = None, align: str = "left", mono: bool = False, most: int | None = None,
) -> float:  # fmt: skip
    """Text whose top is at y [in]; returns the height of its lines [in].

    Args:
        axis: Where to write.
        x: Left end, or middle or right end according to `align` [in].
        y: Top [in].
        text: What to write; line breaks are kept.
        size: Type size [pt].
        colour: Colour of the type.
        bold: Bold type.
        wrap: Characters per line.
        align: left, center or right.
        mono: Type of even width.
        most: Lines after which the text is cut, with dots.
    """
    lines = [line for part in text.split("\n") for line in (textwrap.wrap(part, wrap) if wrap else [part]) or [""]]
    if most is not None and len(lines) > most:
        lines = [*lines[: most - 1], lines[most - 1].rstrip(" .,;") + " …"]
    step = size * LEADING / 72
    # Each line by its base line: aligned by their tops, lines without tall letters would sit higher than others.
    for number, line in enumerate(lines):
        axis.text(
            x, y + 0.8 * size / 72 + number * step, line, fontsize=size, color=colour, ha=align, va="baseline",
            fontweight="bold" if bold else "normal", family="DejaVu Sans Mono" if mono else "DejaVu Sans",
        )  # fmt: skip
    return len(lines) * step


def typeset(text: str) -> str:
    """The agent's plain signs as typographic ones."""
    for plain, sign in (("->", "→"), ("+-", "±"), (" x ", " × "), (" > ", " → ")):
        text = text.replace(plain, sign)
    return text


def arrow(
    axis: Any, start: tuple[float, float], end: tuple[float, float], colour: str = MUTED, *, bend: float = 0.0,
    style: str = "-|>", width: float = 1.6,
) -> None:  # fmt: skip
    """An arrow; `bend` is the height of its bow over its length."""
    from matplotlib.patches import FancyArrowPatch

    axis.add_patch(
        FancyArrowPatch(
            start, end, arrowstyle=style, mutation_scale=11, linewidth=width, color=colour, shrinkA=2, shrinkB=2,
            connectionstyle=f"arc3,rad={bend}",
        )
    )  # fmt: skip


def picture(axis: Any, pixels: NDArray[np.uint8], x: float, y: float, width: float, *, frame: str = RULE) -> float:
    """A picture with its upper left corner at (x, y) [in]; returns its height [in]."""
    from matplotlib.patches import Rectangle

    height = width * pixels.shape[0] / pixels.shape[1]
    axis.imshow(pixels, extent=(x, x + width, y + height, y), aspect="auto", zorder=2, interpolation="lanczos")
    axis.add_patch(Rectangle((x, y), width, height, fill=False, edgecolor=frame, linewidth=1.2, zorder=3))
    # imshow sets the limits to the picture; the sheet keeps its own.
    size = axis.figure.get_size_inches()
    axis.set_xlim(0, size[0])
    axis.set_ylim(size[1], 0)
    return height


def badge(axis: Any, x: float, y: float, text: str, colour: str) -> None:
    """A small filled label over a picture, its upper left corner at (x, y) [in]."""
    axis.text(
        x, y, text, fontsize=SMALL, color=PAPER, fontweight="bold", ha="left", va="top", zorder=5,
        bbox={"boxstyle": "round,pad=0.3", "facecolor": colour, "edgecolor": "none"},
    )  # fmt: skip


def save(figure: Any, path: Path) -> Path:
    """Writes a PNG; the same drawing gives the same bytes."""
    from PIL import Image

    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.open(buffer).convert("RGB").save(path, optimize=True)
    return path
