"""The handle of a long thing: its slim end where the other one is wider (a hammer, a hairbrush), or all of a slim bar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kb.percept import Part
from tools.perception.measure import Measured
from tools.perception.sections import STATIONS

LONG = 2.0
"""Things at least this many times as long as wide may have a handle along their length."""
HANDLE = (0.014, 0.040)
"""Widths that hands hold tools by [m]."""
SHARE = 0.45
"""Share of the length that the slim stretch takes at least."""
WIDER = 1.5
"""The other end is this many times as wide."""
BAR = (0.10, 0.040)
"""A thing longer than the first, lower and narrower than the second is all handle [m]."""


def slim_end(m: Measured) -> tuple[Part, ...]:
    """The handle, or nothing where the thing has no slim end of a width to hold."""
    longer, shorter, _ = (float(value) for value in m.box.size)
    seen = np.isfinite(m.widths)
    if longer < LONG * shorter or shorter > 0.16 or seen.sum() < STATIONS - 3:
        return _bar(m)
    widths = np.interp(np.arange(STATIONS), np.flatnonzero(seen), m.widths[seen])
    for side, ordered in ((-1.0, widths), (1.0, widths[::-1])):
        run = _slim_run(ordered)
        width = float(np.median(ordered[:run])) if run else 0.0
        if run < SHARE * STATIONS or float(ordered[run:].max(initial=0.0)) < WIDER * width:
            continue
        axis = m.box.axes()[0]
        # The outermost stations may be cut short, so the handle is measured between them.
        middle = side * (0.5 - run / 2 / STATIONS) * longer
        centre = m.box.centre + axis * middle
        return (
            Part(
                region="handle",
                centre=(float(centre[0]), float(centre[1]), _height(m, side, run)),
                axis=(float(axis[0]), float(axis[1]), 0.0),
                width=width,
                length=run / STATIONS * longer,
                confidence=0.9,
            ),
        )
    return _bar(m)


def _bar(m: Measured) -> tuple[Part, ...]:
    """A slim bar as a handle, or nothing."""
    longer, shorter, height = (float(value) for value in m.box.size)
    if longer < max(BAR[0], 3.0 * shorter) or max(shorter, height) > BAR[1]:
        return ()
    axis, centre = m.box.axes()[0], m.box.centre
    return (
        Part(
            region="handle",
            centre=(float(centre[0]), float(centre[1]), float(centre[2])),
            axis=(float(axis[0]), float(axis[1]), 0.0),
            width=shorter,
            length=longer,
            confidence=0.7,
        ),
    )


def _slim_run(ordered: NDArray[np.float64]) -> int:
    """Number of stations from the first on that are as wide as handles are."""
    run = 0
    for width in ordered:
        if not HANDLE[0] < width < HANDLE[1]:
            break
        run += 1
    return run


def _height(m: Measured, side: float, run: int) -> float:
    """Half the height of the slim stretch above what the thing lies on [m]."""
    local = m.box.local(m.blob.xyz)
    reach = float(m.box.size[0])
    mine = side * local[:, 0] > reach * (0.5 - run / STATIONS)
    top = float(np.quantile(m.blob.xyz[mine, 2], 0.95)) if mine.sum() >= 10 else m.top
    return (m.base + top) / 2
