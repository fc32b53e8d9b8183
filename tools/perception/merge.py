"""Decide which colour pieces are one object, which are contents of another, and which stand on another.

A screwdriver's handle and shaft, a bottle and its cap differ in colour and are one thing; two blocks side by side
differ in colour and are two. What decides is whether the pieces together look like something known, and whether each
could stand by itself.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kb.references import References
from kb.vocabulary import UNKNOWN_CATEGORY
from tools.perception.blob import CLEAR_LOSS, HIDDEN, Blob
from tools.perception.candidate import Candidate, swallows
from tools.perception.classify import Judgement, classify
from tools.perception.contents import is_inside
from tools.perception.cut_by_shape import best_cut
from tools.perception.features import colour_features, features
from tools.perception.join_clusters import join_clusters
from tools.perception.look import Look
from tools.perception.measure import Measured, measure
from tools.perception.one_thing import continues, is_part_of
from tools.perception.piece_facts import NESTED_BASE, PieceFacts, gap

UNKNOWN_COST = 2.0
"""Cost of an object that nothing known fits; a known one costs up to nothing."""

OBJECT_COST = 0.35
"""Cost of every object: of two equally good readings the one with fewer objects is taken."""

HANGING_COST = 2.5
"""Cost of a piece that would hang in the air if it were an object by itself."""

HANGING = 0.012
"""A piece whose lowest point is higher than this above its support hangs [m]."""


BETTER_ALONE = 0.4
"""What carries something is taken for a thing of its own if it fits a category better than with its load by this."""

SURE = 0.9
"""Novelty (log) up to which what stands on something is taken for a thing of its own."""

COVERED_COST = 0.4
"""Share of the cost of strangeness that is left for a thing with something on top: its top is hidden."""

CRUMB = 0.10
"""A piece with less than this share of the points of a union is more likely a detail of it than a thing [-]."""


THINNEST = 0.0075
"""Nothing lower carries anything [m]: a wine glass's foot is part of the glass."""


HIDDEN_TOP = 0.030
"""How far the top of a base that is hidden from above may be above what is seen of it [m]."""


ON_TABLE = 0.008
"""What is seen lower than this stands on the table [m]; a phone is 10 mm thick."""

FOOT_ON_TABLE = 0.0065
"""What reaches down to this with more than stray points stands on the table [m], in a ring maybe."""

OVERLAP = 0.25
"""What stands on something overlaps it by this share of its width at least, seen from above."""

HAZE_RADIUS = 0.05
"""Distance in chromaticity up to which something may be the slanted side of glass next to it."""

MOST_PIECES = 7
"""Of a cluster with more pieces only the largest are told apart."""


class Merger:
    """Reads one look's pieces as objects."""

    def __init__(self, look: Look, references: References, nouns: tuple[str, ...] = ()) -> None:
        self._facts = PieceFacts(look)
        self._references = references
        self._nouns = nouns
        self._cache: dict[tuple[int, ...], Candidate] = {}

    def objects(self) -> list[Candidate]:
        """The objects of the look."""
        found: list[Candidate] = []
        for pieces in join_clusters(self._facts):
            found += self._read(pieces)
        return [item for item in found if not any(swallows(other, item) for other in found if other is not item)]

    def _read(self, pieces: list[int]) -> list[Candidate]:
        """The cheapest reading of one cluster: pairs of touching groups are merged while that saves cost."""
        sizes = {piece: len(self._facts.blob((piece,)).xyz) for piece in pieces}
        kept = sorted(pieces, key=lambda piece: -sizes[piece])[:MOST_PIECES]
        groups: list[tuple[int, ...]] = [(piece,) for piece in sorted(kept)]
        contents = self._contents(groups)
        groups = [group for group in groups if group[0] not in contents]
        readings = [self._merged(groups)]
        hazy = self._with_haze(groups)
        if hazy != groups:
            readings.append(self._merged(hazy))
        best = min(readings, key=lambda reading: sum(self._candidate(group, reading).cost for group in reading))
        best = self._cut(best, set(contents.values()))
        result: list[Candidate] = []
        for group in best:
            inside = tuple(piece for piece, holder in contents.items() if holder in group)
            result.append(self._candidate(group, best, inside))
        return result

    def _cut(self, groups: list[tuple[int, ...]], holders: set[int]) -> list[tuple[int, ...]]:
        """The groups, with each cut that two shapes explain clearly better than one."""
        result: list[tuple[int, ...]] = []
        for group in groups:
            item = self._candidate(group, groups)
            alone = not (item.holds or item.under is not None or holders & set(group))
            part = best_cut(item.measured, item.judgement, self._judged) if alone else None
            result += [group] if part is None else self._facts.split(group, part)
        return result

    def _judged(self, blob: Blob, support: float, load: Measured | None) -> tuple[Measured, Judgement]:
        """A blob measured by itself, and what it is."""
        measured = measure(blob, support, load)
        shape, colour = features(measured), colour_features(measured)
        return measured, classify(shape, colour, self._references, self._nouns, self._facts.look.noise)

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
        glass = [group for group in groups if self._facts.blob(group).lost() > CLEAR_LOSS]
        joined = {group: set(group) for group in glass}
        taken: set[tuple[int, ...]] = set()
        for _ in range(2):
            for group in groups:
                if group in glass or group in taken or not self._facts.blob(group).all_edge():
                    continue
                for main in glass:
                    near = any(
                        (min(a, b), max(a, b)) in (self._facts.look.pieces.links.keys() | self._facts.hung)
                        for a in group
                        for b in joined[main]
                    )
                    if near and np.hypot(*(self._facts.hue(group[0]) - self._facts.hue(main[0]))[:2]) < HAZE_RADIUS:
                        joined[main] |= set(group)
                        taken.add(group)
                        break
        rest = [group for group in groups if group not in glass and group not in taken]
        return sorted([*(tuple(sorted(pieces)) for pieces in joined.values()), *rest]) if taken else groups

    def _gain(self, groups: list[tuple[int, ...]], i: int, j: int) -> float:
        """Cost saved by merging two groups; negative if they do not touch."""
        upper, lower = self._candidate(groups[i], groups), self._candidate(groups[j], groups)
        glass = min(upper.measured.lost, lower.measured.lost) > CLEAR_LOSS and self._together(groups, i, j).known
        for one, two, group in ((upper, lower, groups[j]), (lower, upper, groups[i])) if not glass else ():
            if one.under in group and one.known and one.judgement.distance < SURE and not two.known:
                return -1.0
            if one.under in group and one.known and two.known:
                return -1.0
            if one.under in group and two.known and two.judgement.distance < SURE:
                both = self._together(groups, i, j)
                if two.judgement.distance < both.judgement.distance - BETTER_ALONE:
                    return -1.0  # a bowl with an apple in it still looks somewhat like a bowl
        pairs = {(min(a, b), max(a, b)) for a in groups[i] for b in groups[j]}
        if not (pairs & self._facts.look.pieces.links.keys() or pairs & self._facts.hung or pairs & self._facts.same):
            return -1.0
        first, second = self._candidate(groups[i], groups), self._candidate(groups[j], groups)
        both = self._together(groups, i, j)
        gain = first.cost + second.cost - both.cost
        if min(first.measured.lost, second.measured.lost) > CLEAR_LOSS:
            return gain + 1.5  # what is seen through glass colours it unevenly
        if self._alike(groups[i], groups[j]):
            return gain + 1.5  # one colour that something else cuts apart
        share = len(first.measured.blob.xyz) / len(both.measured.blob.xyz)
        stacked = first.under in groups[j] or second.under in groups[i]
        for one, two, group in ((first, second, groups[j]), (second, first, groups[i])):
            if (
                one.under in group
                and not (one.known or two.known)
                and is_part_of(one.measured, two.measured, both.measured)
            ):
                return gain
        if not (stacked or first.known or second.known) and continues(first.measured, second.measured, both.measured):
            return gain
        crumb = min(share, 1 - share) < CRUMB and not stacked
        if not (both.known or first.hangs or second.hangs or crumb):
            return -1.0  # two strange things side by side are two
        if both.known and first.known and second.known and not crumb:
            return -1.0  # a cube beside a block may look like a box, but each is something by itself
        return gain

    def _together(self, groups: list[tuple[int, ...]], i: int, j: int) -> Candidate:
        """Two of the groups read as one object."""
        rest = [group for k, group in enumerate(groups) if k not in (i, j)]
        return self._candidate(tuple(sorted(groups[i] + groups[j])), rest)

    def _alike(self, one: tuple[int, ...], two: tuple[int, ...]) -> bool:
        """Two pieces of these groups that touch have the same colour."""
        for a in one:
            for b in two:
                pair = (min(a, b), max(a, b))
                if pair in self._facts.same or (pair in self._facts.look.pieces.links and self._facts.same_hue(a, b)):
                    return True
        return False

    def _candidate(
        self, group: tuple[int, ...], others: list[tuple[int, ...]], contents: tuple[int, ...] = ()
    ) -> Candidate:
        """The group read as one object among the others."""
        under, support = self._support(group, others)
        carried = self._carried(group, others)
        key = (*group, -1, -1 if under is None else under, -1, *contents, -1, *(carried or ()))
        if key not in self._cache:
            blob = self._facts.blob(group)
            if contents:
                inner = self._facts.blob(contents)
                blob = replace(blob, low=np.concatenate([blob.low, inner.xyz[inner.from_top]]))
            nested = carried is not None and self._facts.nested(carried, group)
            load = None if carried is None or nested else self._candidate(carried, [group]).measured
            measured, judgement = self._judged(blob, support, load)
            unknown = judgement.posterior.get(UNKNOWN_CATEGORY, 0.0)
            lowest = self._facts.span(group).foot
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
        return max(on_top, key=lambda other: len(self._facts.blob(other).xyz), default=None)

    def _support(self, group: tuple[int, ...], others: list[tuple[int, ...]]) -> tuple[int | None, float]:
        """The piece under a group and the height at which the group stands [m]; (None, 0) on the table."""
        mine = self._facts.span(group)
        lowest = float(mine.low[2])
        best: tuple[int | None, float] = (None, 0.0)
        if lowest < ON_TABLE or mine.foot < FOOT_ON_TABLE:
            return best
        for other in others:
            if other == group or set(other) & set(group):
                continue
            if self._facts.span(other).low[2] > lowest - 0.003:
                continue  # what carries reaches lower; two things never carry each other
            if self._facts.nested(group, other):
                z = self._facts.blob(group).xyz[:, 2]
                return other[0], float(np.partition(z, min(5, len(z) - 1))[min(5, len(z) - 1)]) - NESTED_BASE
            below = self._facts.span(other)
            top = below.top
            if below.from_top < HIDDEN:
                below = below.mirrored((mine.low + mine.high)[:2] / 2.0)
            if top < THINNEST:
                continue
            if below.from_top < HIDDEN and top < lowest < top + HIDDEN_TOP:
                top = lowest - 0.001  # its own lowest points tell better where it stands
            if (
                gap(mine, below) < -max(0.006, OVERLAP * float((mine.high - mine.low)[:2].min()))
                and top < lowest + 0.010
                and top > best[1]
            ):
                best = (other[0], top)
        return best

    def _contents(self, groups: list[tuple[int, ...]]) -> dict[int, int]:
        """Pieces inside another piece's rim -> that piece."""
        inside: dict[int, int] = {}
        for group in groups:
            blob = self._facts.blob(group)
            for other in groups:
                if other == group or other[0] in inside:
                    continue
                if is_inside(blob, self._candidate(other, groups).measured):
                    inside[group[0]] = other[0]
                    break
        return inside
