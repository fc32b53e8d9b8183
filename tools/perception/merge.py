"""Decide which colour pieces are one object, which are contents of another, and which stand on another.

A screwdriver's handle and shaft, a bottle and its cap differ in colour and are one thing; two blocks side by side
differ in colour and are two. What decides is whether the pieces together look like something known, and whether each
could stand by itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kb.references import References
from kb.vocabulary import UNKNOWN_CATEGORY
from tools.perception.blobs import BlobMaker
from tools.perception.classify import Judgement, classify
from tools.perception.contents import has_rim, is_inside
from tools.perception.features import colour_features, features
from tools.perception.look import Look
from tools.perception.measure import CLEAR_LOSS, HIDDEN, Blob, Measured, covered_top, measure
from tools.perception.segment import BRIGHTNESS_RADIUS, chromaticity

Array = NDArray[np.float64]

UNKNOWN_COST = 2.0
"""Cost of an object that nothing known fits; a known one costs up to nothing."""

OBJECT_COST = 0.35
"""Cost of every object: of two equally good readings the one with fewer objects is taken."""

HANGING_COST = 2.5
"""Cost of a piece that would hang in the air if it were an object by itself."""

HANGING = 0.012
"""A piece whose lowest point is higher than this above its support hangs [m]."""

BESIDE = 0.012
"""Groups this near to each other in plan may be parts of one thing [m]."""

SURE = 0.9
"""Novelty (log) up to which what stands on something is taken for a thing of its own."""

COVERED_COST = 0.4
"""Share of the cost of strangeness that is left for a thing with something on top: its top is hidden."""

CRUMB = 0.10
"""A piece with less than this share of the points of a union is more likely a detail of it than a thing [-]."""

GAP = 0.045
"""How far the top of what is underneath may be hidden below a hanging thing [m]."""

THINNEST = 0.0075
"""Nothing lower carries anything [m]: a wine glass's foot is part of the glass."""

STANDING = 0.014
"""A piece whose lowest points are below this stands on the table [m]."""

HIDDEN_TOP = 0.030
"""How far the top of a base that is hidden from above may be above what is seen of it [m]."""

LOOKS_OUT, NESTED_BASE = 0.008, 0.002
"""What stands in a bowl reaches this far above its rim and below it [m], and this far below its lowest seen points."""

SPLINTER = 0.06
"""Strange things with a smaller share of another one's points, and inside it, are pieces of it."""

HAZE_RADIUS = 0.05
"""Distance in chromaticity up to which something may be the slanted side of glass next to it."""

MOST_PIECES = 7
"""Of a cluster with more pieces only the largest are told apart."""


@dataclass(frozen=True)
class Candidate:
    """A set of pieces read as one object."""

    measured: Measured
    judgement: Judgement
    cost: float
    contents: tuple[int, ...] = ()
    """Pieces seen inside its rim."""
    under: int | None = None
    """A piece that it stands on."""
    holds: bool = False
    """Something stands on it or in it."""
    hangs: bool = False
    """It would hang in the air if it were an object by itself."""

    @property
    def known(self) -> bool:
        """Some category fits it."""
        return self.judgement.category != UNKNOWN_CATEGORY


@dataclass(frozen=True)
class Span:
    """Where a group of pieces lies."""

    low: Array
    """2-% quantiles of x, y, z (3,) [m]."""
    high: Array
    """98-% quantiles of x, y, z (3,) [m]."""
    top: float
    """Height of its top, should something stand on it [m]."""
    from_top: float
    """Share of the points that the top camera sees."""


class Merger:
    """Reads one look's pieces as objects."""

    def __init__(self, look: Look, references: References, nouns: tuple[str, ...] = ()) -> None:
        self._look = look
        self._maker: BlobMaker = look.maker
        self._references = references
        self._nouns = nouns
        self._hung: set[tuple[int, int]] = set()
        """Pairs of pieces of which one hangs above the other."""
        self._same: set[tuple[int, int]] = set()
        """Pairs of pieces of one colour that something covers between."""
        self._cache: dict[tuple[int, ...], Candidate] = {}
        self._spans: dict[tuple[int, ...], Span] = {}
        self._nests: dict[tuple[tuple[int, ...], tuple[int, ...]], bool] = {}
        self._hues: dict[int, Array] = {}
        self._blobs: dict[tuple[int, ...], Blob] = {}

    def objects(self) -> list[Candidate]:
        """The objects of the look."""
        found: list[Candidate] = []
        for pieces in self._clusters():
            found += self._read(pieces)
        return [item for item in found if not any(_swallows(other, item) for other in found if other is not item)]

    def _clusters(self) -> list[list[int]]:
        """Pieces per spatial cluster; what hangs in the air joins the cluster under it.

        A wine glass's bowl hides the upper end of its stem from the front camera, so that they do not touch.
        """
        groups = [
            [int(piece) for piece in np.flatnonzero(self._look.pieces.cluster == cluster)]
            for cluster in np.unique(self._look.pieces.cluster)
        ]
        spans = [self._span(tuple(group)) for group in groups]
        for i in sorted(range(len(groups)), key=lambda i: -spans[i].low[2]):
            low, high = spans[i].low, spans[i].high
            if low[2] < 0.02:
                continue
            best: tuple[float, int] | None = None
            for j in range(len(groups)):
                if i == j or not groups[j]:
                    continue
                xyz = self._blob(tuple(groups[j])).xyz
                under = np.all((xyz[:, :2] > low[:2]) & (xyz[:, :2] < high[:2]), axis=1) & (xyz[:, 2] < low[2] + 0.005)
                if under.sum() >= 15 and low[2] - (top := float(xyz[under, 2].max())) < GAP:
                    best = max(best or (-1.0, -1), (top, j))
            if best is None:
                best = self._like_neighbour(i, groups)
            if best is not None:
                for mine in groups[i]:
                    self._hung |= {(min(mine, other), max(mine, other)) for other in groups[best[1]]}
                groups[best[1]] = sorted(groups[best[1]] + groups[i])
                groups[i] = []
        return self._joined_under_covers([group for group in groups if group])

    def _joined_under_covers(self, groups: list[list[int]]) -> list[list[int]]:
        """Joins clusters of which low pieces of one colour come out from under the same higher piece."""
        owner = {piece: k for k, group in enumerate(groups) for piece in group}
        spans = {piece: self._span((piece,)) for piece in owner}
        low = [piece for piece in owner if spans[piece].low[2] < 2 * STANDING]
        for a in low:
            for b in low:
                if a >= b or (a, b) in self._look.pieces.links or not self._same_hue(a, b):
                    continue
                top = max(spans[a].high[2], spans[b].high[2])
                for cover in owner:
                    if cover in (a, b) or spans[cover].low[2] < top - 0.008:
                        continue
                    gaps = [_gap(spans[cover], spans[x]) for x in (a, b)]
                    if max(gaps) < BESIDE:
                        self._same.add((a, b))
                        for x in (a, b):
                            old, new = owner[x], owner[cover]
                            for piece in [piece for piece in owner if owner[piece] == old]:
                                owner[piece] = new
        numbers = sorted(set(owner.values()))
        return [sorted(piece for piece in owner if owner[piece] == number) for number in numbers]

    def _like_neighbour(self, i: int, groups: list[list[int]]) -> tuple[float, int] | None:
        """The group of the same colour right beside a hanging one: the step down between them is hidden from the front."""
        mine = self._span(tuple(groups[i]))
        for j, group in enumerate(groups):
            for piece in group if j != i else ():
                if _gap(mine, self._span((piece,))) < BESIDE and any(self._same_hue(own, piece) for own in groups[i]):
                    return 0.0, j
        return None

    def _read(self, pieces: list[int]) -> list[Candidate]:
        """The cheapest reading of one cluster: pairs of touching groups are merged while that saves cost."""
        sizes = {piece: len(self._blob((piece,)).xyz) for piece in pieces}
        kept = sorted(pieces, key=lambda piece: -sizes[piece])[:MOST_PIECES]
        groups: list[tuple[int, ...]] = [(piece,) for piece in sorted(kept)]
        contents = self._contents(groups)
        groups = [group for group in groups if group[0] not in contents]
        readings = [self._merged(groups)]
        hazy = self._with_haze(groups)
        if hazy != groups:
            readings.append(self._merged(hazy))
        best = min(readings, key=lambda reading: sum(self._candidate(group, reading).cost for group in reading))
        result: list[Candidate] = []
        for group in best:
            inside = tuple(piece for piece, holder in contents.items() if holder in group)
            result.append(self._candidate(group, best, inside))
        return result

    def _merged(self, groups: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
        """Merges the pair that saves most cost until no pair saves any."""
        groups = list(groups)
        while len(groups) > 1:
            best: tuple[float, int, int] | None = None
            for i in range(len(groups)):
                for j in range(i + 1, len(groups)):
                    gain = self._gain(groups, i, j)
                    if gain > 0 and (best is None or gain > best[0]):
                        best = (gain, i, j)
            if best is None:
                break
            _, i, j = best
            groups[i] = tuple(sorted(groups[i] + groups[j]))
            del groups[j]
        return groups

    def _with_haze(self, groups: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
        """The groups with what may be the steep sides of glass joined to it.

        On a side seen at a slant every pixel counts as an edge, so that nothing tells whether it is clear; its colour
        resembles that of the glass, which is mostly the colour behind.
        """
        glass = [group for group in groups if self._blob(group).lost() > CLEAR_LOSS]
        joined = {group: set(group) for group in glass}
        taken: set[tuple[int, ...]] = set()
        for _ in range(2):
            for group in groups:
                if group in glass or group in taken or not self._blob(group).all_edge():
                    continue
                for main in glass:
                    near = any(
                        (min(a, b), max(a, b)) in (self._look.pieces.links.keys() | self._hung)
                        for a in group
                        for b in joined[main]
                    )
                    if near and np.hypot(*(self._hue(group[0]) - self._hue(main[0]))[:2]) < HAZE_RADIUS:
                        joined[main] |= set(group)
                        taken.add(group)
                        break
        rest = [group for group in groups if group not in glass and group not in taken]
        return sorted([*(tuple(sorted(pieces)) for pieces in joined.values()), *rest]) if taken else groups

    def _gain(self, groups: list[tuple[int, ...]], i: int, j: int) -> float:
        """Cost saved by merging two groups; negative if they do not touch."""
        upper, lower = self._candidate(groups[i], groups), self._candidate(groups[j], groups)
        for one, two, group in ((upper, lower, groups[j]), (lower, upper, groups[i])):
            if one.under in group and one.known and one.judgement.distance < SURE and not two.known:
                return -1.0
            if one.under in group and one.known and two.known:
                return -1.0
        pairs = {(min(a, b), max(a, b)) for a in groups[i] for b in groups[j]}
        if not (pairs & self._look.pieces.links.keys() or pairs & self._hung or pairs & self._same):
            return -1.0
        first, second = self._candidate(groups[i], groups), self._candidate(groups[j], groups)
        rest = [group for k, group in enumerate(groups) if k not in (i, j)]
        both = self._candidate(tuple(sorted(groups[i] + groups[j])), rest)
        gain = first.cost + second.cost - both.cost
        if min(first.measured.lost, second.measured.lost) > CLEAR_LOSS:
            return gain + 1.5  # what is seen through glass colours it unevenly
        if self._alike(groups[i], groups[j]):
            return gain + 1.5  # one colour that something else cuts apart
        share = len(first.measured.blob.xyz) / len(both.measured.blob.xyz)
        stacked = first.under in groups[j] or second.under in groups[i]
        crumb = min(share, 1 - share) < CRUMB and not stacked
        if not (both.known or first.hangs or second.hangs or crumb):
            return -1.0  # two strange things side by side are two
        if both.known and first.known and second.known and not crumb:
            return -1.0  # a cube beside a block may look like a box, but each is something by itself
        return gain

    def _span(self, group: tuple[int, ...]) -> Span:
        """Extents of a group without its outermost points, from the cache."""
        if group not in self._spans:
            blob = self._blob(group)
            ordered = np.sort(blob.xyz, axis=0)
            count = len(ordered)
            low, high = ordered[int(0.02 * (count - 1))], ordered[int(np.ceil(0.98 * (count - 1)))]
            self._spans[group] = Span(low, high, covered_top(blob), float(blob.from_top.mean()))
        return self._spans[group]

    def _alike(self, one: tuple[int, ...], two: tuple[int, ...]) -> bool:
        """Two pieces of these groups that touch have the same colour."""
        for a in one:
            for b in two:
                pair = (min(a, b), max(a, b))
                if pair in self._same or (pair in self._look.pieces.links and self._same_hue(a, b)):
                    return True
        return False

    def _same_hue(self, a: int, b: int) -> bool:
        one, two = self._hue(a), self._hue(b)
        reach = max(0.026, 0.012 / float(np.exp(min(one[2], two[2]))))  # dark colours are noisy
        near = np.hypot(*(one - two)[:2]) < reach and abs(one[2] - two[2]) < BRIGHTNESS_RADIUS / 2
        return bool(near) and max(self._blob((piece,)).lost() for piece in (a, b)) < CLEAR_LOSS

    def _hue(self, piece: int) -> Array:
        if piece not in self._hues:
            self._hues[piece] = chromaticity(np.median(self._blob((piece,)).rgb, axis=0)[None])[0]
        return self._hues[piece]

    def _blob(self, group: tuple[int, ...]) -> Blob:
        if group not in self._blobs:
            self._blobs[group] = self._maker.blob(group)
        return self._blobs[group]

    def _candidate(
        self, group: tuple[int, ...], others: list[tuple[int, ...]], contents: tuple[int, ...] = ()
    ) -> Candidate:
        """The group read as one object among the others."""
        under, support = self._support(group, others)
        carried = self._carried(group, others)
        key = (*group, -1, -1 if under is None else under, -1, *contents, -1, *(carried or ()))
        if key not in self._cache:
            blob = self._blob(group)
            if contents:
                inner = self._blob(contents)
                blob = replace(blob, low=np.concatenate([blob.low, inner.xyz[inner.from_top]]))
            nested = carried is not None and self._nested(carried, group)
            load = None if carried is None or nested else self._candidate(carried, [group]).measured
            measured = measure(blob, support, load)
            judgement = classify(features(measured), colour_features(measured), self._references, self._nouns)
            unknown = judgement.posterior.get(UNKNOWN_CATEGORY, 0.0)
            lowest = float(self._span(group).low[2])
            hangs = lowest - support > HANGING + 0.35 * (measured.top - support)
            strange = UNKNOWN_COST * unknown * (1.0 if carried is None else COVERED_COST)
            cost = OBJECT_COST + strange + HANGING_COST * hangs
            self._cache[key] = Candidate(measured, judgement, cost, contents, under, carried is not None, hangs)
        return self._cache[key]

    def _carried(self, group: tuple[int, ...], others: list[tuple[int, ...]]) -> tuple[int, ...] | None:
        """The largest group that stands on this one, if any."""
        on_top = [
            other for other in others if not set(other) & set(group) and self._support(other, [group])[0] is not None
        ]
        return max(on_top, key=lambda other: len(self._blob(other).xyz), default=None)

    def _support(self, group: tuple[int, ...], others: list[tuple[int, ...]]) -> tuple[int | None, float]:
        """The piece under a group and the height at which the group stands [m]; (None, 0) on the table."""
        mine = self._span(group)
        lowest = float(mine.low[2])
        best: tuple[int | None, float] = (None, 0.0)
        if lowest < STANDING:
            return best
        for other in others:
            if other == group or set(other) & set(group):
                continue
            if self._nested(group, other):
                z = self._blob(group).xyz[:, 2]
                return other[0], float(np.partition(z, min(5, len(z) - 1))[min(5, len(z) - 1)]) - NESTED_BASE
            below = self._span(other)
            top = below.top
            if top < THINNEST:
                continue
            if below.from_top < HIDDEN and top < lowest < top + HIDDEN_TOP:
                top = lowest - 0.001  # its own lowest points tell better where it stands
            if _gap(mine, below) < -0.006 and top < lowest + 0.010 and top > best[1]:
                best = (other[0], top)
        return best

    def _nested(self, group: tuple[int, ...], other: tuple[int, ...]) -> bool:
        """The group stands in the hollow of the other one and looks out of it."""
        mine, around = self._span(group), self._span(other)
        within = np.all(mine.low > around.low + 0.004) and np.all(mine.high[:2] < around.high[:2] - 0.004)
        if not within or mine.high[2] < around.high[2] + LOOKS_OUT or mine.low[2] > around.high[2] - LOOKS_OUT:
            return False
        if (group, other) not in self._nests:
            holder = measure(self._blob(other))
            reach = np.hypot(*(self._blob(group).xyz[:, :2] - holder.centre).T)
            inside = holder.is_round and np.quantile(reach, 0.9) < 0.96 * holder.radius
            self._nests[group, other] = bool(inside and has_rim(holder))
        return self._nests[group, other]

    def _contents(self, groups: list[tuple[int, ...]]) -> dict[int, int]:
        """Pieces inside another piece's rim -> that piece."""
        inside: dict[int, int] = {}
        for group in groups:
            blob = self._blob(group)
            for other in groups:
                if other == group or other[0] in inside:
                    continue
                if is_inside(blob, self._candidate(other, groups).measured):
                    inside[group[0]] = other[0]
                    break
        return inside


def _gap(one: Span, two: Span) -> float:
    """Free distance of two groups' bounding rectangles seen from above [m], negative if they overlap."""
    return float(np.max(np.maximum(one.low[:2], two.low[:2]) - np.minimum(one.high[:2], two.high[:2])))


def _swallows(big: Candidate, small: Candidate) -> bool:
    """The small one's points are a few of the big one's own that did not link up with the rest."""
    xyz, holder = small.measured.blob.xyz, big.measured
    if len(xyz) > SPLINTER * len(holder.blob.xyz) or small.known or big.under in small.measured.blob.pieces:
        return False
    if holder.is_round or holder.is_ball:
        offset = xyz[:, :2] - holder.centre
        inside = np.hypot(offset[:, 0], offset[:, 1]) < holder.radius + 0.004
    else:
        inside = np.all(np.abs(holder.box.local(xyz)[:, :2]) < holder.box.size[:2] / 2 + 0.004, axis=1)
    return bool(np.mean(inside & (xyz[:, 2] < holder.top + 0.003)) > 0.85)
