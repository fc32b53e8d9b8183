"""Colours that a category plausibly has (benchmark.md section 2): colour alone must not give a category away."""

from __future__ import annotations

import colorsys
from collections.abc import Callable

import numpy as np

from sim.objects.form import Colour

Palette = Callable[[np.random.Generator], Colour]
"""Draws one colour."""


def anything(rng: np.random.Generator) -> Colour:
    """Any colour: three quarters are saturated hues, the rest greys from black to white."""
    if rng.random() < 0.25:
        grey = float(rng.uniform(0.08, 0.95))
        return (grey, grey, grey, 1.0)
    r, g, b = colorsys.hsv_to_rgb(float(rng.random()), float(rng.uniform(0.35, 0.95)), float(rng.uniform(0.3, 0.95)))
    return (r, g, b, 1.0)


def among(*colours: tuple[float, float, float], spread: float = 0.06, alpha: float = 1.0) -> Palette:
    """A palette of one of the given colours, each channel shifted by up to `spread`."""

    def draw(rng: np.random.Generator) -> Colour:
        base = colours[int(rng.integers(len(colours)))]
        r, g, b = (float(np.clip(c + rng.uniform(-spread, spread), 0.02, 0.98)) for c in base)
        return (r, g, b, alpha)

    return draw


APPLE = among((0.72, 0.08, 0.10), (0.45, 0.65, 0.15), (0.90, 0.75, 0.20))
"""Red, green or yellow."""
BANANA = among((0.93, 0.82, 0.20), (0.72, 0.78, 0.25), (0.70, 0.55, 0.15))
"""Ripe, green or overripe."""
WOOD = among((0.75, 0.56, 0.35), (0.50, 0.32, 0.18), (0.88, 0.75, 0.55), (0.62, 0.25, 0.15))
GLASS = among((0.80, 0.88, 0.92), (0.55, 0.78, 0.70), (0.45, 0.60, 0.85), (0.80, 0.60, 0.35), alpha=0.45)
CLEAR_GLASS = among((0.82, 0.87, 0.92), (0.70, 0.74, 0.78), alpha=0.45)
PHONE = among((0.06, 0.06, 0.07), (0.30, 0.31, 0.33), (0.88, 0.88, 0.86), (0.12, 0.22, 0.42), (0.55, 0.15, 0.18))
TENNIS = among((0.80, 0.92, 0.20), (0.70, 0.82, 0.25), (0.90, 0.62, 0.20))
METAL = among((0.62, 0.63, 0.66), (0.75, 0.62, 0.30), (0.50, 0.38, 0.28))
