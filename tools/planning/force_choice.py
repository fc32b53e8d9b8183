"""The grip force: what experience says, within what friction and leverage need and what the object bears."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kb.grasp import MAX_FORCE, MIN_FORCE, Provenance
from kb.percept import PerceivedObject
from kb.vocabulary import UNKNOWN_CATEGORY
from sim.quality import GRAVITY, maximum_force, minimum_force
from tools.planning.candidate import DOWNWARD, TIP_REACH, Array, Candidate
from tools.planning.grasp_prior import GraspPrior

DAMAGE_SPREAD = 0.8
"""The weakest specimen breaks at this share of the nominal force (benchmark.md section 1: x U(0.8, 1.25))."""
CLOSING_PEAK = 0.76
"""Share of the damage force that the commanded force may take: closing peaks overshoot it
by up to a third (measured on stems and necks)."""
EASY_FACTOR = 3.5
"""Without any experience: this many times the no-slip minimum, within the cap (measured on the catalogue)."""
LEAST_FORCE = 4.0
"""Without any experience the fingers close with at least this force [N], if the object bears it."""
TWIST_RADIUS = 0.014
"""Effective radius at which a pad's friction resists turning about the closing axis [m]: pads are 18 x 18 mm (measured: a cup
0.07 m beside its weight is carried by 12 N)."""
TWIST_RESERVE = 1.5
"""Times the least force against turning that is commanded: a cup held by its handle with a fifth more than the least turns
by 6 degrees while it is lifted."""
FILLED = 2.0
"""A vessel with contents may weigh this many times as much as without."""
PAD_LENGTH = 0.0178
"""Pads along the fingers [m]."""
PAD_ARM = 0.014
"""Arm of the couple with which two pads resist turning in their own plane [m] (measured: a bowl of
0.35 kg by its rim falls at 7 N, stays at 11 N)."""


@dataclass(frozen=True)
class ForceTerms:
    """What the force follows from; the force itself also depends on the candidate's leverage."""

    base: float
    """What prior, memory or correction asks for, after constraints [N]."""
    floor: float
    """f_min [N]: 1.5 times what holds the expected mass at the expected friction (ledger G9, G15)."""
    cap: float
    """What the weakest plausible specimen bears [N]."""
    mass: float
    """Expected mass [kg]."""
    friction: float
    centre: tuple[float, float]
    """Where the weight acts, horizontally [m]."""
    top: float
    """Height of the object's highest point [m]."""
    steps: tuple[Provenance, ...]
    """Where `base` comes from."""
    gentle: float | None = None
    """What even the most fragile reading of an unknown object bears [N]: a test lift may raise the grip from there."""
    literal: bool = False
    """The force is `base` as it stands, within what the motor can do: neither floor nor cap (the paper as printed)."""

    def force(self, candidate: Candidate) -> float:
        """Force per finger for a candidate [N]."""
        if self.literal:
            return min(MAX_FORCE, max(MIN_FORCE, self.base))
        cap = self.cap if self.gentle is None else min(self.cap, self.gentle)
        return min(MAX_FORCE, max(MIN_FORCE, min(max(self.base, self.floor, self.tipping(candidate)), cap)))

    def tipping(self, candidate: Candidate) -> float:
        """Force below which the weight, hanging beside the grip, turns the object between the pads [N]."""
        x, y = candidate.position[0] - self.centre[0], candidate.position[1] - self.centre[1]
        cosine, sine = math.cos(candidate.yaw), math.sin(candidate.yaw)
        along, across = abs(x * cosine + y * sine), abs(y * cosine - x * sine)
        # Of a thin thing the pads only hold what stands above the fingertips.
        covered = PAD_LENGTH
        if candidate.approach[2] < DOWNWARD:
            covered = min(PAD_LENGTH, max(0.004, self.top - (candidate.position[2] - TIP_REACH)))
        radius = TWIST_RADIUS * covered / PAD_LENGTH
        weight = self.mass * GRAVITY
        return weight * max(TWIST_RESERVE * across / (2.0 * self.friction * radius), along / PAD_ARM)

    def provenance(self, candidate: Candidate) -> tuple[Provenance, ...]:
        """The steps that led to `force`."""
        steps, force = list(self.steps), self.base
        if self.literal:
            return tuple(steps)
        for value, name in ((self.floor, "no-slip floor"), (self.tipping(candidate), "weight beside the grip")):
            if force < value:
                force = value
                steps.append(Provenance(source="geometry", id=name, value=round(value, 2)))
        if force > self.cap:
            steps.append(Provenance(source="geometry", id="fragility cap", value=round(self.cap, 2)))
        if self.gentle is not None and force > self.gentle:
            said = "may be fragile: test lift first"
            steps.append(Provenance(source="geometry", id=said, value=round(self.gentle, 2)))
        return tuple(steps)


def force_terms(
    subject: PerceivedObject,
    prior: GraspPrior,
    *,
    scale: float,
    scale_reason: str,
    corrected: float | None = None,
    rule: str = "",
    filled: bool = False,
) -> ForceTerms:
    """Collects what decides about the force per finger.

    Args:
        subject: The target: ranges of mass and friction, fragility.
        prior: The suggestion that gives the force, if it gives one.
        scale: Factor of the active constraints (0.8 beside a fragile neighbour).
        scale_reason: Id of those constraints for the provenance.
        corrected: Force demanded by a correction [N]; it replaces prior and scale.
        rule: Name of that correction.
        filled: Whether there is something in it that must stay there.
    """
    mass = (prior.mass or sum(subject.mass) / 2) * (FILLED if filled else 1.0)
    friction = sum(subject.friction) / 2
    cap = max(MIN_FORCE, CLOSING_PEAK * DAMAGE_SPREAD * maximum_force(subject.affordance.fragility))
    # A fragile object that needs more than it surely bears is held with what it surely bears.
    floor = min(cap, max(MIN_FORCE, minimum_force(mass, friction)))
    steps: list[Provenance] = []
    if corrected is not None:
        base = corrected
        steps.append(Provenance(source="correction", id=rule, value=round(corrected, 2)))
    else:
        known = prior.force is not None
        base = prior.force if prior.force is not None else max(EASY_FACTOR * floor, LEAST_FORCE)
        name = prior.id if known else f"{EASY_FACTOR:g} times the no-slip minimum"
        steps.append(Provenance(source=prior.source if known else "default", id=name, value=round(base, 2)))
        if scale != 1.0:
            base *= scale
            steps.append(Provenance(source="constraint", id=scale_reason, value=f"x {scale:g}"))
    return ForceTerms(
        base=base,
        floor=floor,
        cap=cap,
        mass=mass,
        friction=friction,
        centre=weight_centre(subject),
        top=subject.top_z,
        steps=tuple(steps),
        gentle=first_force(subject) if corrected is None else None,
    )


def force_cap(fragility: float) -> float:
    """What the weakest plausible specimen of a fragility bears while the fingers close [N]."""
    return max(MIN_FORCE, CLOSING_PEAK * DAMAGE_SPREAD * maximum_force(fragility))


def expected_mass(subject: PerceivedObject) -> float:
    """Mass to reckon with before the first contact [kg]: the middle of the range.

    Of a thing of no known category the range spans more than a decade, so the middle is the geometric one; the test lift
    tells the rest.
    """
    if subject.category == UNKNOWN_CATEGORY:
        return math.sqrt(subject.mass[0] * subject.mass[1])
    return sum(subject.mass) / 2


def first_force(subject: PerceivedObject) -> float | None:
    """Force [N] that the most fragile plausible reading of an unknown object bears; None for known ones.

    What has a stem weighs as little as it bears, so it gets no least force: 3 N hold a flute of glass.
    """
    if subject.fragility_range is None:
        return None
    bears = force_cap(subject.fragility_range[1])
    return bears if subject.affordance.region == "stem" else max(LEAST_FORCE, bears)


def weight_centre(subject: PerceivedObject) -> tuple[float, float]:
    """Where the weight acts, horizontally [m]: the vessel's axis, else the middle of what was seen.

    Handles weigh little, so that a cup's box, which contains its handle, would mislead. Long bent things (a banana) have
    their weight where their points are.
    """
    for part in subject.parts:
        if part.region == "rim" and part.radius is not None:
            return part.centre[0], part.centre[1]
    body = subject.part("body")
    if body is not None and body.radius is not None:
        return body.centre[0], body.centre[1]
    points_w: Array = subject.surface_points()
    if subject.shape == "bar" and len(points_w) > 20:
        middle = np.median(points_w, axis=0)
        return float(middle[0]), float(middle[1])
    return subject.position[0], subject.position[1]
