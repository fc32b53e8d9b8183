"""The core's visual embedder: a compact, hand-made descriptor of shape and colour (no learning, no network).

It is not CLIP and does not pretend to be: it knows the hues of the object's pixels, the outline of its mask and how its
depth bulges. Every group is non-negative and has a fixed share of the squared length, so that cosines lie in [0, 1]
and the share of colour is known.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kb.errors import BadInputError

Array = NDArray[np.float64]

HUES, SATURATIONS, GREYS = 12, 2, 4
SIDE = 48
"""Side of the square grid on which the outline is described [cells]."""
RINGS, SECTORS, ROWS, BULGES = 8, 16, 12, 6
GREY_CHROMA = 0.12
"""Chroma (max - min of r, g, b in [0, 1]) below which a pixel counts as grey."""
DEPTH_SPAN = 0.12
"""Range of relative depth that is described [m]: about the depth of a cup."""

SHARES = {"colour": 0.25, "rows": 0.25, "sectors": 0.2, "rings": 0.15, "bulge": 0.1, "shape": 0.05}
"""Share of each group in the squared length. Colour is free for most categories, so it gets a quarter."""

LEVELS = 6
"""Bumps per number: a number is spread over the bumps near it, so that different numbers give different directions
(profiles themselves are alike: their cosines are all near 1)."""

_SIZES = {
    "colour": HUES * SATURATIONS + GREYS,
    "rows": LEVELS * ROWS,
    "sectors": LEVELS * SECTORS,
    "rings": RINGS,
    "bulge": BULGES,
    "shape": 2 * LEVELS,
}


class ShapeColourEmbedder:
    """Embeds a masked crop by colour histogram, row profile, radial profile, rings and depth bulge."""

    @property
    def name(self) -> str:
        return "shape-colour-1"

    @property
    def dim(self) -> int:
        return sum(_SIZES.values())

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None
    ) -> NDArray[np.float64]:
        """Embeds one object (see `kb.embedder.Embedder.embed`).

        Raises:
            BadInputError: if the mask is empty or the shapes do not fit together.
        """
        if rgb.shape[:2] != mask.shape or rgb.shape[2:] != (3,) or (depth is not None and depth.shape != mask.shape):
            depth_shape = None if depth is None else depth.shape
            raise BadInputError(f"picture {rgb.shape}, mask {mask.shape} and depth {depth_shape} do not fit together")
        rows, columns = np.nonzero(mask)
        if rows.size == 0:
            raise BadInputError("the mask is empty: there is nothing to embed")
        outline = _grid(mask, rows, columns)
        groups: dict[str, Array] = {
            "colour": _colour(rgb[rows, columns].astype(np.float64) / 255.0),
            "rows": _row_profile(outline),
            **_polar(outline),
            "bulge": np.zeros(BULGES) if depth is None else _bulge(depth[rows, columns].astype(np.float64)),
            "shape": _shape(rows, columns),
        }
        parts: list[Array] = []
        for key, size in _SIZES.items():
            group = np.sqrt(groups[key])  # Hellinger: cosines of square roots compare distributions gently
            length = float(np.linalg.norm(group))
            parts.append(np.zeros(size) if length == 0.0 else group * (np.sqrt(SHARES[key]) / length))
        vector = np.concatenate(parts)
        return vector / np.linalg.norm(vector)


def _grid(mask: NDArray[np.bool_], rows: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.bool_]:
    """The mask's square bounding box sampled on SIDE x SIDE cells; the aspect ratio is kept by centring."""
    side = max(int(np.ptp(rows)), int(np.ptp(columns))) + 1
    top = (int(rows.min()) + int(rows.max()) + 1 - side) / 2.0
    left = (int(columns.min()) + int(columns.max()) + 1 - side) / 2.0
    steps = (np.arange(SIDE) + 0.5) * side / SIDE
    r, c = np.floor(top + steps).astype(int), np.floor(left + steps).astype(int)
    inside = ((r >= 0) & (r < mask.shape[0]))[:, None] & ((c >= 0) & (c < mask.shape[1]))[None, :]
    sampled = mask[np.clip(r, 0, mask.shape[0] - 1)[:, None], np.clip(c, 0, mask.shape[1] - 1)[None, :]] & inside
    if not sampled.any():  # a thread-thin mask can fall between the samples
        sampled[SIDE // 2, SIDE // 2] = True
    return sampled


def _colour(pixels: Array) -> Array:
    """Soft histogram of hue x saturation, with grey levels apart; pixels (N, 3) in [0, 1]."""
    high, low = pixels.max(axis=1), pixels.min(axis=1)
    chroma = high - low
    grey = chroma < GREY_CHROMA
    result = np.zeros(_SIZES["colour"])
    if (~grey).any():
        p, c, h = pixels[~grey], chroma[~grey], high[~grey]
        r, g, b = p[:, 0], p[:, 1], p[:, 2]
        sector = (r - g) / c + 4.0
        sector[h == g] = ((b - r) / c)[h == g] + 2.0
        sector[h == r] = ((g - b) / c)[h == r] % 6.0
        hue = sector / 6.0
        position = hue * HUES - 0.5
        first = np.floor(position)
        share = position - first
        saturation = np.minimum((c / np.maximum(h, 1e-9) * SATURATIONS).astype(int), SATURATIONS - 1)
        for bin_, weight in ((first, 1.0 - share), (first + 1.0, share)):
            result[: HUES * SATURATIONS] += np.bincount(
                (bin_.astype(int) % HUES) * SATURATIONS + saturation, weights=weight, minlength=HUES * SATURATIONS
            )
    if grey.any():
        level = np.minimum((high[grey] * GREYS).astype(int), GREYS - 1)
        result[HUES * SATURATIONS :] += np.bincount(level, minlength=GREYS)
    return result / len(pixels)


def _bumps(values: Array) -> Array:
    """Numbers in [0, 1] (N,) as shares of `LEVELS` Gaussian bumps each, shape (N * LEVELS,); each number sums to 1."""
    centres = np.linspace(0.0, 1.0, LEVELS)
    width = centres[1] - centres[0]
    shares = np.exp(-(((np.clip(values, 0.0, 1.0)[:, None] - centres) / width) ** 2))
    return (shares / shares.sum(axis=1, keepdims=True)).ravel()


def _row_profile(outline: NDArray[np.bool_]) -> Array:
    """Filled width per horizontal band, as bumps."""
    return _bumps(outline.reshape(ROWS, SIDE // ROWS, SIDE).mean(axis=(1, 2)))


def _polar(outline: NDArray[np.bool_]) -> dict[str, Array]:
    """Reach of the outline per direction from its centroid, and share of its area per ring."""
    r, c = np.nonzero(outline)
    y, x = r - r.mean(), c - c.mean()
    distance = np.hypot(x, y)
    sector = np.floor((np.arctan2(y, x) + np.pi) / (2.0 * np.pi) * SECTORS).astype(int) % SECTORS
    reach = np.zeros(SECTORS)
    np.maximum.at(reach, sector, distance)
    ring = np.minimum((distance / (SIDE / 2.0) * RINGS).astype(int), RINGS - 1)
    return {"sectors": _bumps(reach / (SIDE / 2.0)), "rings": np.bincount(ring, minlength=RINGS) / len(r)}


def _bulge(depth: Array) -> Array:
    """Histogram of depth behind the nearest point (5 % quantile); zeros if nothing was measured."""
    measured = depth[depth > 0]
    if measured.size == 0:
        return np.zeros(BULGES)
    behind = np.clip(measured - np.quantile(measured, 0.05), 0.0, DEPTH_SPAN * (1 - 1e-9))
    return np.bincount((behind / DEPTH_SPAN * BULGES).astype(int), minlength=BULGES) / measured.size


def _shape(rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Array:
    """Extent (area over bounding box) and aspect (height over height plus width), as bumps."""
    height, width = float(np.ptp(rows) + 1), float(np.ptp(columns) + 1)
    return _bumps(np.array([len(rows) / (height * width), height / (height + width)]))
