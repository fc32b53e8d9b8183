"""A set of pieces read as one object, and which readings are only splinters of another one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kb.vocabulary import UNKNOWN_CATEGORY
from tools.perception.classify import Judgement
from tools.perception.limb import is_limb, nearest
from tools.perception.measure import Measured

LIMB = 0.025
"""A splinter smaller than this and nearer than this to a strange thing [m] is a limb whose root is hidden: a foot, a knob."""

SPLINTER = 0.06
"""Strange things with a smaller share of another one's points, and inside it, are pieces of it."""


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


def swallows(big: Candidate, small: Candidate) -> bool:
    """The small one's points are a few of the big one's own that did not link up with the rest."""
    xyz, holder = small.measured.blob.xyz, big.measured
    strange = not (big.known or small.known)
    if strange and small.under is None and is_limb(small.measured.blob, holder.blob):
        return True
    if len(xyz) > SPLINTER * len(holder.blob.xyz) or small.known or big.under in small.measured.blob.pieces:
        return False
    tiny = float(np.ptp(xyz, axis=0).max()) < LIMB and small.under is None
    if tiny and not big.known and nearest(xyz, holder.blob.xyz, LIMB) < LIMB:
        return True
    if holder.is_round or holder.is_ball:
        offset = xyz[:, :2] - holder.centre
        inside = np.hypot(offset[:, 0], offset[:, 1]) < holder.radius + 0.004
    else:
        inside = np.all(np.abs(holder.box.local(xyz)[:, :2]) < holder.box.size[:2] / 2 + 0.004, axis=1)
    return bool(np.mean(inside & (xyz[:, 2] < holder.top + 0.003)) > 0.85)
