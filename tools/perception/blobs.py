"""Blobs: the points of one or several colour pieces, with what the views say about them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.perception.blob import Blob
from tools.perception.calibrate_view import CalibratedView
from tools.perception.object_points import ObjectPoints
from tools.perception.segment import Pieces

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BlobMaker:
    """Makes blobs out of pieces."""

    points: ObjectPoints
    label: NDArray[np.intp]
    """Piece of each point (N,)."""
    eyes: Array
    """Camera positions: front, top (2, 3) [m]."""
    top: int
    """Number of the top view."""
    top_view: CalibratedView

    def blob(self, pieces: tuple[int, ...]) -> Blob:
        """All points of these pieces as one blob."""
        chosen = np.flatnonzero(np.isin(self.label, pieces))
        sizes = [int((self.label[chosen] == piece).sum()) for piece in pieces]
        return Blob(
            xyz=self.points.xyz[chosen],
            rgb=self.points.rgb[chosen],
            from_top=self.points.view[chosen] == self.top,
            clear=self.points.clear[chosen],
            pieces=pieces,
            second_share=1.0 - max(sizes) / max(sum(sizes), 1),
            eyes=self.eyes,
            pixel=self.points.pixel[chosen],
            low=self._low_points(self.points.xyz[chosen]),
        )

    def _low_points(self, xyz: Array) -> Array:
        """Points (K, 3) of the top view taken for the table within the bounding rectangle of `xyz`."""
        lower, upper = xyz.min(0), xyz.max(0)
        corners = np.array([[x, y, 0.0] for x in (lower[0], upper[0]) for y in (lower[1], upper[1])])
        u, v, _ = self.top_view.project(corners)
        rows = slice(max(int(v.min()), 0), max(int(v.max()) + 1, 0))
        columns = slice(max(int(u.min()), 0), max(int(u.max()) + 1, 0))
        patch = self.top_view.points[rows, columns].reshape(-1, 3)
        seen = self.top_view.measured[rows, columns].reshape(-1)
        inside = (
            seen
            & (patch[:, 2] <= self.points.lowest)
            & np.all((patch[:, :2] > lower[:2]) & (patch[:, :2] < upper[:2]), axis=1)
        )
        return patch[inside].astype(np.float64)


def blob_maker(views: tuple[CalibratedView, ...], points: ObjectPoints, pieces: Pieces) -> BlobMaker:
    """Prepares blobs of one look; the front and the top view are needed."""
    names = [view.name for view in views]
    eyes = np.stack([views[names.index(name)].pose[:3, 3] for name in ("front", "top")])
    top = names.index("top")
    return BlobMaker(points, pieces.label, eyes, top, views[top])
