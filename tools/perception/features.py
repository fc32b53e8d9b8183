"""The numbers by which categories are told apart: mostly geometry, and colour apart from it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tools.perception.measure import Measured
from tools.perception.sections import LEVELS, STATIONS
from tools.perception.segment import chromaticity

Array = NDArray[np.float64]

FEATURES: tuple[str, ...] = (
    "log_longer",
    "log_shorter",
    "log_height",
    "log_height_over_shorter",
    "roughness",
    "harmonic_2",
    "harmonic_3",
    "harmonic_4",
    "bulge",
    "ball_misfit",
    "ball_radius",
    "hollow",
    "wall",
    *(f"profile_{k}" for k in range(6)),
    "low_z",
    "middle_z",
    "high_z",
    "fill",
    "footprint",
    "thick_end",
    "thin_end",
    "bend",
    "lost",
    "second_colour",
)
"""Names of the geometric features, in order."""

COLOURS: tuple[str, ...] = ("red", "green", "brightness")
"""Names of the colour features: chromaticity and log brightness of the largest piece."""


def features(measured: Measured) -> Array:
    """The geometric features of one object, shape (len(FEATURES),)."""
    longer, shorter, height = np.maximum(measured.box.size, 2e-3)
    view = measured.outline
    above = measured.blob.xyz[measured.blob.from_top, 2]
    z = (above if len(above) >= 20 else measured.blob.xyz[:, 2]) - measured.base
    low, middle, high = np.clip(np.quantile(z / height, [0.1, 0.5, 0.9]), -0.2, 1.2)
    thick, thin = _ends(measured.widths, float(shorter))
    misfit = float(np.log(measured.sphere.residual / max(measured.sphere.radius, 5e-3) + 0.004))
    return np.array(
        [
            np.log(longer),
            np.log(shorter),
            np.log(height),
            np.log(height / shorter),
            min(view.roughness, 0.45),
            *np.minimum(view.harmonics, 0.8),
            min(max(view.bulge, 0.0) / max(view.radius, 5e-3), 1.5),
            misfit,
            float(np.clip(np.log(max(measured.sphere.radius, 5e-3) * 2 / shorter), -1.0, 1.5)),
            min(measured.hollow, 0.3) / 0.3,
            0.0 if np.isnan(measured.wall) else min(measured.wall, 0.02) * 50,
            *_profile(measured, float(max(longer, 2 * measured.radius)) / 2),
            low,
            middle,
            high,
            float(np.clip(view.hull_area / (longer * shorter), 0.3, 1.2)),
            float(np.clip(measured.footprint, 0.0, 1.4)),
            thick,
            thin,
            min(measured.sagitta, 0.4),
            measured.lost,
            measured.blob.second_share,
        ]
    )


def colour_features(measured: Measured) -> Array:
    """Chromaticity and log brightness of the better lit half of the points, shape (3,)."""
    rgb = measured.blob.rgb
    total = rgb.sum(1)
    return chromaticity(rgb[total >= np.median(total)].mean(0)[None])[0]


def _profile(measured: Measured, reach: float) -> Array:
    """Outer radius over the largest one at six heights; unseen heights take the nearest seen one's."""
    pairs = measured.profile.reshape(6, LEVELS // 6)
    seen = np.isfinite(pairs)
    mean = np.where(seen.any(1), np.nansum(np.where(seen, pairs, 0.0), 1) / np.maximum(seen.sum(1), 1), np.nan)
    known = np.flatnonzero(np.isfinite(mean))
    if not len(known):
        return np.ones(6)
    return np.clip(np.interp(np.arange(6), known, mean[known]) / max(reach, 2e-3), 0.0, 1.6)


def _ends(widths: Array, shorter: float) -> tuple[float, float]:
    """Mean width of the thicker and of the thinner half of the longer axis, over the shorter side."""
    halves = [widths[: STATIONS // 2], widths[STATIONS // 2 :]]
    means = sorted(float(np.mean(h[np.isfinite(h)])) if np.isfinite(h).any() else 0.0 for h in halves)
    return min(means[1] / shorter, 1.3), min(means[0] / shorter, 1.3)
