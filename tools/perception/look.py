"""From pictures to colour pieces: the stages before any decision about objects, and one object measured alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kb.errors import BadInputError
from kb.rgbd import RgbdView
from tools.perception.blobs import BlobMaker, blob_maker
from tools.perception.calibrate_view import CalibratedView, calibrate_view
from tools.perception.contents import is_inside
from tools.perception.lost_glass import restore_glass
from tools.perception.measure import Measured, measure
from tools.perception.object_points import object_points
from tools.perception.segment import Pieces, segment

NOISE_SHARE = 0.03
"""Clusters with a smaller share of all points are not part of the only thing on the table."""


@dataclass(frozen=True)
class Look:
    """Both pictures, calibrated and cut into pieces."""

    views: tuple[CalibratedView, ...]
    pieces: Pieces
    maker: BlobMaker

    @property
    def noise(self) -> float:
        """Depth noise over the ordinary one; at least 1."""
        return max(view.noise for view in self.views)


def take_apart(views: tuple[RgbdView, ...]) -> Look:
    """Calibrates the views, drops the table and cuts the rest into pieces.

    Raises:
        BadInputError: if the front or the top view is missing.
    """
    names = [view.name for view in views]
    for name in ("front", "top"):
        if name not in names:
            raise BadInputError(f"perception needs the {name} view", where="views", choices=("front", "top"))
    ready = restore_glass(tuple(calibrate_view(view) for view in views))
    points = object_points(ready)
    pieces = segment(points)
    return Look(ready, pieces, blob_maker(ready, points, pieces))


def measure_alone(views: tuple[RgbdView, ...]) -> Measured | None:
    """The only thing on the table, all its pieces together; None if nothing is seen. For reference views."""
    look = take_apart(views)
    if not len(look.pieces.cluster):
        return None
    amount = np.bincount(look.maker.label[look.maker.label >= 0], minlength=len(look.pieces.cluster))
    weight = np.bincount(look.pieces.cluster, weights=amount)
    kept = np.flatnonzero(weight[look.pieces.cluster] > NOISE_SHARE * weight.sum())
    return measure_apart_from_contents(look.maker, [int(piece) for piece in kept])


def measure_apart_from_contents(maker: BlobMaker, pieces: list[int]) -> Measured:
    """Measures all pieces as one thing, less those that lie inside its rim."""
    whole = measure(maker.blob(tuple(pieces)))
    if not whole.is_round:
        return whole
    contents = [piece for piece in pieces if is_inside(maker.blob((piece,)), whole)]
    shell = tuple(piece for piece in pieces if piece not in contents)
    if not contents or not shell:
        return whole
    inner = maker.blob(tuple(contents))
    blob = maker.blob(shell)
    return measure(replace(blob, low=np.concatenate([blob.low, inner.xyz[inner.from_top]])))
