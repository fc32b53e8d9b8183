"""Which pieces may belong together although they do not touch: what hangs, and what comes out from under a cover."""

from __future__ import annotations

import numpy as np

from tools.perception.piece_facts import PieceFacts, gap

GAP = 0.045
"""How far the top of what is underneath may be hidden below a hanging thing [m]."""

BESIDE = 0.012
"""Groups this near to each other in plan may be parts of one thing [m]."""

STANDING = 0.014
"""A piece whose lowest points are below this stands on the table [m]."""


def join_clusters(facts: PieceFacts) -> list[list[int]]:
    """Pieces per spatial cluster; what hangs in the air joins the cluster under it.

    A wine glass's bowl hides the upper end of its stem from the front camera, so that they do not touch.
    """
    groups = [
        [int(piece) for piece in np.flatnonzero(facts.look.pieces.cluster == cluster)]
        for cluster in np.unique(facts.look.pieces.cluster)
    ]
    spans = [facts.span(tuple(group)) for group in groups]
    for i in sorted(range(len(groups)), key=lambda i: -spans[i].low[2]):
        low, high = spans[i].low, spans[i].high
        if low[2] < 0.02:
            continue
        best: tuple[float, int] | None = None
        for j in range(len(groups)):
            if i == j or not groups[j]:
                continue
            xyz = facts.blob(tuple(groups[j])).xyz
            under = np.all((xyz[:, :2] > low[:2]) & (xyz[:, :2] < high[:2]), axis=1) & (xyz[:, 2] < low[2] + 0.005)
            if under.sum() >= 15 and low[2] - (top := float(xyz[under, 2].max())) < GAP:
                best = max(best or (-1.0, -1), (top, j))
        if best is None:
            best = _like_neighbour(facts, i, groups)
        if best is not None:
            for mine in groups[i]:
                facts.hung |= {(min(mine, other), max(mine, other)) for other in groups[best[1]]}
            groups[best[1]] = sorted(groups[best[1]] + groups[i])
            groups[i] = []
    return _joined_under_covers(facts, [group for group in groups if group])


def _joined_under_covers(facts: PieceFacts, groups: list[list[int]]) -> list[list[int]]:
    """Joins clusters of which low pieces of one colour come out from under the same higher piece."""
    owner = {piece: k for k, group in enumerate(groups) for piece in group}
    spans = {piece: facts.span((piece,)) for piece in owner}
    low = [piece for piece in owner if spans[piece].low[2] < 2 * STANDING]
    for a in low:
        for b in low:
            if a >= b or (a, b) in facts.look.pieces.links or not facts.same_hue(a, b):
                continue
            top = max(spans[a].high[2], spans[b].high[2])
            for cover in owner:
                if cover in (a, b) or spans[cover].low[2] < top - 0.008:
                    continue
                gaps = [gap(spans[cover], spans[x]) for x in (a, b)]
                if max(gaps) < BESIDE:
                    facts.same.add((a, b))
                    for x in (a, b):
                        old, new = owner[x], owner[cover]
                        for piece in [piece for piece in owner if owner[piece] == old]:
                            owner[piece] = new
    numbers = sorted(set(owner.values()))
    return [sorted(piece for piece in owner if owner[piece] == number) for number in numbers]


def _like_neighbour(facts: PieceFacts, i: int, groups: list[list[int]]) -> tuple[float, int] | None:
    """The group of the same colour right beside a hanging one: the step down between them is hidden from the front."""
    mine = facts.span(tuple(groups[i]))
    for j, group in enumerate(groups):
        for piece in group if j != i else ():
            if gap(mine, facts.span((piece,))) < BESIDE and any(facts.same_hue(own, piece) for own in groups[i]):
                return 0.0, j
    return None
