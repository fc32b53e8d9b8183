"""Two endings as one picture: left what was, right what would have been, a row for each camera."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

MARGIN, CAPTION, LETTERS = 8, 44, 24
"""Pixels between pictures, for the words above them, and their size."""


def side_by_side(file: Path, left: tuple[str, tuple[Any, ...]], right: tuple[str, tuple[Any, ...]]) -> None:
    """Writes the PNG at once or not at all.

    Args:
        file: Where to.
        left: Caption and views (`kb.rgbd.RgbdView`).
        right: Caption and views of the same cameras.

    Raises:
        OSError: it cannot be written.
    """
    from PIL import Image, ImageDraw, ImageFont

    pairs = list(zip(left[1], right[1], strict=True))
    height, width = pairs[0][0].rgb.shape[:2]
    sheet = Image.new("RGB", (2 * width + 3 * MARGIN, CAPTION + len(pairs) * (height + MARGIN)), (24, 26, 30))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(LETTERS)
    for column, (caption, _) in enumerate((left, right)):
        x = MARGIN + column * (width + MARGIN)
        draw.text((x, MARGIN), _fitting(draw, caption, width, font), fill=(235, 235, 235), font=font)
        for row, pair in enumerate(pairs):
            sheet.paste(Image.fromarray(pair[column].rgb), (x, CAPTION + row * (height + MARGIN)))
    buffer = io.BytesIO()
    sheet.save(buffer, format="PNG")
    part = file.with_suffix(".part")
    part.write_bytes(buffer.getvalue())
    part.replace(file)


def _fitting(draw: Any, text: str, width: int, font: Any) -> str:
    """As much of the text as fits."""
    while draw.textlength(text, font=font) > width and len(text) > 4:
        text = text[:-4] + "..."
    return text
