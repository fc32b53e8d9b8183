"""Colours of objects: robust mean, hue and saturation that ignore shading, and a name for people."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_NAMES: tuple[tuple[str, float], ...] = (
    ("red", 14.0),
    ("orange", 42.0),
    ("yellow", 70.0),
    ("green", 165.0),
    ("turquoise", 195.0),
    ("blue", 258.0),
    ("purple", 292.0),
    ("pink", 340.0),
    ("red", 360.0),
)
"""Upper hue [deg] of each colour name on the hue circle."""


YELLOWISH, VIVID = 42.0, 0.55
"""Hues [deg] from the first on, more saturated than the second, are a shaded yellow rather than brown."""


def hue_saturation_value(rgb: Array) -> Array:
    """Hue [deg], saturation and value of colours (..., 3) in [0, 1]."""
    high, low = rgb.max(-1), rgb.min(-1)
    spread = high - low
    safe = np.where(spread > 0, spread, 1.0)
    r, g, b = rgb[..., 0], rgb[..., 1], rgb[..., 2]
    hue = np.where(high == r, (g - b) / safe % 6, np.where(high == g, (b - r) / safe + 2, (r - g) / safe + 4)) * 60.0
    saturation = np.where(high > 0, spread / np.where(high > 0, high, 1.0), 0.0)
    return np.stack([np.where(spread > 0, hue, 0.0), saturation, high], axis=-1)


def colour_name(rgb: tuple[float, float, float]) -> str:
    """A name that people use for a colour in [0, 1]."""
    hue, saturation, value = hue_saturation_value(np.asarray(rgb, float))
    if value < 0.16:
        return "black"
    if saturation < 0.16:
        return "white" if value > 0.66 else "grey"
    if 10 <= hue < 48 and value < 0.72 and saturation < 0.8 and not (hue > YELLOWISH and saturation > VIVID):
        return "brown"
    return next(name for name, upper in _NAMES if hue <= upper)


def mean_colour(rgb: NDArray[np.uint8]) -> tuple[float, float, float]:
    """Mean colour in [0, 1] of the better lit half of the pixels (N, 3): shading darkens, light never brightens."""
    if len(rgb) == 0:
        return (0.5, 0.5, 0.5)
    value = rgb.max(-1)
    bright = rgb[value >= np.median(value)].mean(0) / 255.0
    return (float(bright[0]), float(bright[1]), float(bright[2]))
