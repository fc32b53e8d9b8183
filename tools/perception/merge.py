"""Decide which colour pieces are one object, which are contents of another, and which stand on another.

A screwdriver's handle and shaft, a bottle and its cap differ in colour and are one thing; two blocks side by side
differ in colour and are two. What decides is whether the pieces together look like something known, and whether each
could stand by itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kb.references import References
from kb.vocabulary import UNKNOWN_CATEGORY
from tools.perception.blobs import BlobMaker
from tools.perception.classify import Judgement, classify
from tools.perception.features import colour_features, features
from tools.perception.look import Look
from tools.perception.measure import CLEAR_LOSS, Blob, Measured, measure

UNKNOWN_COST = 2.0
"""Cost of an object that nothing known fits; a known one costs up to nothing."""

OBJECT_COST = 0.35
"""Cost of every object: of two equally good readings the one with fewer objects is taken."""

HANGING_COST = 2.5
"""Cost of a piece that would hang in the air if it were an object by itself."""

HANGING = 0.012
"""A piece whose lowest point is higher than this above its support hangs [m]."""

CRUMB = 0.10
"""A piece with less than this share of the points of a union is more likely a detail of it than a thing [-]."""

GAP = 0.045
"""How far the top of what is underneath may be hidden below a hanging thing [m]."""

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
    hangs: bool = False
    """It would hang in the air if it were an object by itself."""

    @property
    def known(self) -> bool:
        """Some category fits it."""
        return self.judgement.category != UNKNOWN_CATEGORY


class Merger:
    """Reads one look's pieces as objects."""

    def __init__(self, look: Look, references: References, nouns: tuple[str, ...] = ()) -> None:
        self._look = look
        self._maker: BlobMaker = look.maker
        self._references = references
        self._nouns = nouns
        self._hung: set[tuple[int, int]] = set()
        """Pairs of pieces of which one hangs above the other."""
        self._cache: dict[tuple[int, ...], Candidate] = {}
        self._blobs: dict[tuple[int, ...], Blob] = {}

    def objects(self) -> list[Candidate]:
        """The objects of the look."""
        found: list[Candidate] = []
        for pieces in self._clusters():
            found += self._read(pieces)
        return found

    def _clusters(self) -> list[list[int]]:
        """Pieces per spatial cluster; what hangs in the air joins the cluster under it.

        A wine glass's bowl hides the upper end of its stem from the front camera, so that they do not touch.
        """
        groups = [
            [int(piece) for piece in np.flatnonzero(self._look.pieces.cluster == cluster)]
            for cluster in np.unique(self._look.pieces.cluster)
        ]
        spans = [np.quantile(self._blob(tuple(group)).xyz, [0.02, 0.98], axis=0) for group in groups]
        for i in sorted(range(len(groups)), key=lambda i: -spans[i][0, 2]):
            low, high = spans[i]
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
            if best is not None:
                for mine in groups[i]:
                    self._hung |= {(min(mine, other), max(mine, other)) for other in groups[best[1]]}
                groups[best[1]] = sorted(groups[best[1]] + groups[i])
                groups[i] = []
        return [group for group in groups if group]

    def _read(self, pieces: list[int]) -> list[Candidate]:
        """The cheapest reading of one cluster: pairs of touching groups are merged while that saves cost."""
        sizes = {piece: len(self._blob((piece,)).xyz) for piece in pieces}
        kept = sorted(pieces, key=lambda piece: -sizes[piece])[:MOST_PIECES]
        groups: list[tuple[int, ...]] = [(piece,) for piece in sorted(kept)]
        contents = self._contents(groups)
        groups = [group for group in groups if group[0] not in contents]
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
        result: list[Candidate] = []
        for group in groups:
            inside = tuple(piece for piece, holder in contents.items() if holder in group)
            result.append(self._candidate(group, groups, inside))
        return result

    def _gain(self, groups: list[tuple[int, ...]], i: int, j: int) -> float:
        """Cost saved by merging two groups; negative if they do not touch."""
        pairs = {(min(a, b), max(a, b)) for a in groups[i] for b in groups[j]}
        if not (pairs & self._look.pieces.links.keys() or pairs & self._hung):
            return -1.0
        first, second = self._candidate(groups[i], groups), self._candidate(groups[j], groups)
        rest = [group for k, group in enumerate(groups) if k not in (i, j)]
        both = self._candidate(tuple(sorted(groups[i] + groups[j])), rest)
        gain = first.cost + second.cost - both.cost
        if min(first.measured.lost, second.measured.lost) > CLEAR_LOSS:
            return gain + 1.5  # what is seen through glass colours it unevenly
        share = len(first.measured.blob.xyz) / len(both.measured.blob.xyz)
        crumb = min(share, 1 - share) < CRUMB
        if not (both.known or first.hangs or second.hangs or crumb):
            return -1.0  # two strange things side by side are two
        if both.known and first.known and second.known and not crumb:
            return -1.0  # a cube beside a block may look like a box, but each is something by itself
        return gain

    def _blob(self, group: tuple[int, ...]) -> Blob:
        if group not in self._blobs:
            self._blobs[group] = self._maker.blob(group)
        return self._blobs[group]

    def _candidate(
        self, group: tuple[int, ...], others: list[tuple[int, ...]], contents: tuple[int, ...] = ()
    ) -> Candidate:
        """The group read as one object among the others."""
        under, support = self._support(group, others)
        key = (*group, -1, -1 if under is None else under, -1, *contents)
        if key not in self._cache:
            blob = self._blob(group)
            if contents:
                inner = self._blob(contents)
                blob = replace(blob, low=np.concatenate([blob.low, inner.xyz[inner.from_top]]))
            measured = measure(blob, support)
            judgement = classify(features(measured), colour_features(measured), self._references, self._nouns)
            unknown = judgement.posterior.get(UNKNOWN_CATEGORY, 0.0)
            lowest = float(np.quantile(blob.xyz[:, 2], 0.02))
            hangs = lowest - support > HANGING + 0.35 * (measured.top - support)
            cost = OBJECT_COST + UNKNOWN_COST * unknown + HANGING_COST * hangs
            self._cache[key] = Candidate(measured, judgement, cost, contents, under, hangs)
        return self._cache[key]

    def _support(self, group: tuple[int, ...], others: list[tuple[int, ...]]) -> tuple[int | None, float]:
        """The piece under a group and the height at which the group stands [m]; (None, 0) on the table."""
        blob = self._blob(group)
        lowest = float(np.quantile(blob.xyz[:, 2], 0.02))
        if lowest < 0.014:
            return None, 0.0
        middle = np.median(blob.xyz[:, :2], axis=0)
        best: tuple[int | None, float] = (None, 0.0)
        for other in others:
            if other == group or set(other) & set(group):
                continue
            xyz = self._blob(other).xyz
            low, high = np.quantile(xyz, [0.01, 0.99], axis=0)
            beneath = np.all((middle > low[:2] - 0.004) & (middle < high[:2] + 0.004))
            top = float(high[2])
            if beneath and top < lowest + 0.010 and top > best[1]:
                best = (other[0], top)
        return best

    def _contents(self, groups: list[tuple[int, ...]]) -> dict[int, int]:
        """Pieces inside another piece's rim -> that piece."""
        inside: dict[int, int] = {}
        for group in groups:
            blob = self._blob(group)
            for other in groups:
                if other == group or other[0] in inside:
                    continue
                holder = self._candidate(other, groups).measured
                if not holder.is_round or holder.radius < 0.02 or len(holder.blob.xyz) < 0.5 * len(blob.xyz):
                    continue
                reach = np.hypot(*(blob.xyz[:, :2] - holder.centre).T)
                within = np.quantile(reach, 0.95) < 0.96 * holder.radius and blob.from_top.mean() > 0.3
                if within and np.quantile(blob.xyz[:, 2], 0.95) < holder.top + 0.004 and self._ring(holder):
                    inside[group[0]] = other[0]
                    break
        return inside

    @staticmethod
    def _ring(holder: Measured) -> bool:
        """The holder's highest points form a ring: it has a rim and not a lid."""
        xyz = holder.blob.xyz
        high = xyz[(xyz[:, 2] > holder.top - 0.006) & holder.blob.from_top]
        if len(high) < 15:
            return False
        reach = np.hypot(*(high[:, :2] - holder.centre).T)
        return bool(np.quantile(reach, 0.3) > 0.7 * holder.radius)
