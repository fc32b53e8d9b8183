"""Cut what looks like one strange thing into two known ones: things of one colour that lean, lie inside, stack, touch.

A strange thing stays whole unless two shapes explain it clearly better: a flat thing that leans on something known,
something in a bowl, a known thing on a known one, or two known ones at both ends of a neck.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kb.vocabulary import UNKNOWN_CATEGORY
from tools.perception.blob import CLEAR_LOSS, Blob
from tools.perception.classify import Judgement
from tools.perception.measure import Measured
from tools.perception.neck import heights_of_steps, necks
from tools.perception.tilted_slab import tilted_slab

Mask = NDArray[np.bool_]

STRANGE = 0.3
"""Only what is unknown with at least this probability is cut."""

SURE = 0.9
"""Novelty (log) up to which a part is taken for a thing of its own."""

SLAB_REST, SLAB_DROP, LARGE_FACE = 2.2, 1.5, 0.006
"""Behind a leaning face of at least the last area [m^2], which hides much, the rest's novelty may be the first if it is
less than the whole's by the second."""

FEWEST = 120
"""Points of a part: with fewer nothing tells what it is."""

SHADED = 3.0
"""Novelty (log) of what carries a flat known thing, which hides its top, at most."""

FEWEST_BELOW = 60
"""Points of what carries a wider thing, which hides most of it."""

FEWEST_UNDER, CARRIED_HIGH = 20, 0.025
"""A flat thing that is surely known, and so high above the table [m], is carried by whatever shows this many points."""

HOLDERS = ("bowl", "cup", "mug")
"""What has room for a thing of some size."""

INNER = (0.92, 0.83, 0.74, 0.65)
"""Shares of a holder's radius within which its content may lie."""

LOOKS_OUT, STRANGE_CONTENT = 0.010, 3.0
"""What nothing known fits is content if it reaches this far above the rim [m], and counts as so strange (log novelty)."""

HOLDER_REST, HOLDER_DROP = 1.5, 1.1
"""A holder whose wall is partly hidden by what sticks out of it may be this strange if it is by so much less strange than
the whole (log novelty)."""

FLOOR = 0.2
"""Content reaches higher than this share of its holder [-]."""

FLAT = 0.0105
"""A flat thing on top may be this thick [m]: below it the other one is hidden, so that no step is seen."""

Judge = Callable[[Blob, float, Measured | None], tuple[Measured, Judgement]]
"""Measures a blob that stands at a height [m] with a load on it, if any, and says what it is."""


def best_cut(whole: Measured, judgement: Judgement, judge: Judge) -> Mask | None:
    """One side (N,) of the first cut that explains the whole clearly better; None if it had better stay whole."""
    blob = whole.blob
    if judgement.posterior.get(UNKNOWN_CATEGORY, 0.0) < STRANGE or len(blob.xyz) < 2 * FEWEST:
        return None
    clear = blob.lost() > CLEAR_LOSS
    for find in (_leaning, _contained, _known_pair) if not clear else (_side_by_side,):
        cut = find(whole, judgement, judge)
        if cut is not None:
            return cut
    return None


def part_of(blob: Blob, mask: Mask) -> Blob:
    """Some of a blob's points (N,) as a blob."""
    return replace(
        blob,
        xyz=blob.xyz[mask],
        rgb=blob.rgb[mask],
        from_top=blob.from_top[mask],
        clear=blob.clear[mask],
        pixel=blob.pixel[mask],
        second_share=0.0,
    )


def _leaning(whole: Measured, judgement: Judgement, judge: Judge) -> Mask | None:
    """A tilted slab in front of something known."""
    blob = whole.blob
    slab = tilted_slab(blob.xyz)
    if slab is None or not _enough(slab.part):
        return None
    _, rest = judge(part_of(blob, ~slab.part), 0.0, None)
    most = SURE
    if slab.sides[0] * slab.sides[1] > LARGE_FACE:
        most = max(SURE, min(SLAB_REST, judgement.distance - SLAB_DROP))
    return slab.part if rest.distance < most else None


def _contained(whole: Measured, judgement: Judgement, judge: Judge) -> Mask | None:
    """A known thing that sticks out of a bowl."""
    if not whole.is_round:
        return None
    blob = whole.blob
    reach = np.hypot(*(blob.xyz[:, :2] - whole.centre).T)
    high = blob.xyz[:, 2] > whole.base + FLOOR * (whole.top - whole.base)
    best: tuple[float, Mask] | None = None
    for share in INNER:
        part = high & (reach < share * whole.radius)
        if not _enough(part):
            continue
        _, outer = judge(part_of(blob, ~part), 0.0, None)
        sticks_out = whole.top - float(np.quantile(blob.xyz[~part, 2], 0.98)) > LOOKS_OUT
        most = max(SURE, min(HOLDER_REST, judgement.distance - HOLDER_DROP)) if sticks_out else SURE
        if outer.category not in HOLDERS or outer.distance > most:
            continue
        content, inner = judge(part_of(blob, part), 0.0, None)
        fits = content.is_ball or inner.distance < SURE
        if not (fits or sticks_out):
            continue
        misfit = outer.distance + (inner.distance if fits else STRANGE_CONTENT)
        if best is None or misfit < best[0]:
            best = misfit, part
    return None if best is None else best[1]


def _known_pair(whole: Measured, judgement: Judgement, judge: Judge) -> Mask | None:
    """Two known things, one on the other or side by side."""
    upper = _stacked(whole, judge)
    return _side_by_side(whole, judgement, judge) if upper is None else upper


def _stacked(whole: Measured, judge: Judge) -> Mask | None:
    """A known thing on a known one."""
    blob = whole.blob
    for number, height in enumerate((whole.top - FLAT, *heights_of_steps(blob.xyz))):
        upper = blob.xyz[:, 2] > height
        seen_below = int((~upper).sum())
        flat = number == 0 and height - whole.base > CARRIED_HIGH
        if int(upper.sum()) < FEWEST_BELOW or seen_below < (FEWEST_UNDER if flat else FEWEST_BELOW):
            continue
        load, above = judge(part_of(blob, upper), height, None)
        if not _known(above):
            continue
        if flat and above.distance < SURE:
            return upper
        if seen_below < FEWEST_BELOW:
            continue
        below = judge(part_of(blob, ~upper), 0.0, load)[1]
        if _both(above, below) or (number == 0 and below.distance < SHADED):
            return upper
    return None


def _side_by_side(whole: Measured, judgement: Judgement, judge: Judge) -> Mask | None:
    """Two known things at both sides of a neck."""
    for side in necks(whole.blob.xyz):
        if not _enough(side):
            continue
        one = judge(part_of(whole.blob, side), 0.0, None)[1]
        if _known(one) and _both(one, judge(part_of(whole.blob, ~side), 0.0, None)[1]):
            return side
    return None


def _known(judgement: Judgement) -> bool:
    """Some category fits."""
    return judgement.category != UNKNOWN_CATEGORY


def _both(one: Judgement, two: Judgement) -> bool:
    """Some category fits either, and one of them well."""
    return _known(one) and _known(two) and min(one.distance, two.distance) < SURE


def _enough(part: Mask) -> bool:
    """Both sides have points."""
    return min(int(part.sum()), int((~part).sum())) >= FEWEST
