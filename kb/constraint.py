"""Constraints inferred from the scene graph and their adjustment vector (Sec. III-B; ledger G2-G11)."""

from __future__ import annotations

from pydantic import Field

from kb.base import Finite, Noun, Vec3
from kb.vocabulary import ConstraintKind


class Constraint(Noun):
    """One active constraint of the target."""

    kind: ConstraintKind
    target: str
    """Perceived id of the object that the constraint protects or concerns (neighbour, supported object, occluder; the
    target itself for content)."""
    reason: str
    """Why, in one sentence with the measured numbers."""
    gap: Finite | None = None
    """Measured surface gap to the target of the grasp [m]."""


class Adjustment(Noun):
    """Delta g = (Delta d, Delta psi, Delta f, Delta h, Delta v, pre[]), composed in the order of ledger G11."""

    direction: Vec3 | None = None
    """Approach direction imposed by content preservation: (0, 0, -1)."""
    away: Vec3 = (0.0, 0.0, 0.0)
    """Sum of horizontal unit vectors target -> fragile neighbour, scaled 0.3 each, to be added to d (ledger G11)."""
    lateral: Vec3 | None = None
    """Unit vector of the lateral side from which an occluder is avoided, horizontal."""
    avoid_yaw: tuple[Finite, ...] = ()
    """Azimuths [rad] of neighbours along which the closing axis should not lie."""
    force_scale: Finite = 1.0
    """0.8 per active collision constraint with a fragile neighbour (once)."""
    standoff: Finite = 0.0
    """Added to h [m]: +0.03 with a fragile neighbour."""
    speed: Finite = 1.0
    """Cap on the velocity scale v: 0.3 with contents."""
    max_tilt: Finite | None = None
    """Cap on the tilt of the approach [rad] while contents must be kept (15 degrees)."""
    remove_first: tuple[str, ...] = ()
    """Perceived ids to be removed before the target, in this order (topmost first)."""
    margin: Finite = 1.0
    """Scale of the safety margins; 1.5 after a constraint violation (ledger G18)."""


class Constraints(Noun):
    """What `infer_constraints` returns."""

    active: tuple[Constraint, ...] = ()
    adjustment: Adjustment = Field(default_factory=Adjustment)
