"""The grip force: what experience says, within what friction needs and what the object bears."""

from __future__ import annotations

from dataclasses import dataclass

from kb.grasp import MAX_FORCE, MIN_FORCE, Provenance
from kb.percept import PerceivedObject
from sim.quality import maximum_force, minimum_force
from tools.planning.grasp_prior import GraspPrior

DAMAGE_SPREAD = 0.8
"""The weakest specimen breaks at this share of the nominal force (benchmark.md section 1: x U(0.8, 1.25))."""
CLOSING_PEAK = 0.9
"""Share of the damage force that the commanded force may take: closing peaks overshoot it."""
EASY_FACTOR = 2.0
"""Without any experience: this many times the no-slip minimum, within the cap."""
LEAST_FORCE = 4.0
"""Without any experience the fingers close with at least this force [N], if the object bears it."""


@dataclass(frozen=True)
class ForceChoice:
    """The chosen force, its bounds and why."""

    force: float
    floor: float
    """f_min [N]: 1.5 times what holds the expected mass at the expected friction (ledger G9, G15)."""
    cap: float
    """What the weakest plausible specimen bears [N]."""
    mass: float
    """Expected mass [kg]."""
    friction: float
    provenance: tuple[Provenance, ...]


def choose_force(
    subject: PerceivedObject,
    prior: GraspPrior,
    *,
    scale: float,
    scale_reason: str,
    learnt_mass: float | None = None,
    corrected: float | None = None,
    rule: str = "",
) -> ForceChoice:
    """Chooses the force per finger.

    Args:
        subject: The target: ranges of mass and friction, fragility.
        prior: The suggestion that gives the force, if it gives one.
        scale: Factor of the active constraints (0.8 beside a fragile neighbour).
        scale_reason: Id of those constraints for the provenance.
        learnt_mass: Mass measured in an earlier attempt [kg].
        corrected: Force demanded by a correction [N]; it replaces prior and scale.
        rule: Name of that correction.
    """
    mass = learnt_mass or prior.mass or sum(subject.mass) / 2
    friction = sum(subject.friction) / 2
    floor = min(MAX_FORCE, max(MIN_FORCE, minimum_force(mass, friction)))
    cap = max(MIN_FORCE, CLOSING_PEAK * DAMAGE_SPREAD * maximum_force(subject.affordance.fragility))
    # A fragile object that needs more than it surely bears is held with what it surely bears.
    floor = min(floor, cap)
    steps: list[Provenance] = []
    if corrected is not None:
        force = corrected
        steps.append(Provenance(source="correction", id=rule, value=round(corrected, 2)))
    else:
        force = prior.force if prior.force is not None else max(EASY_FACTOR * floor, LEAST_FORCE)
        known = prior.force is not None
        steps.append(
            Provenance(
                source=prior.source if known else "default",
                id=prior.id if known else "twice the no-slip minimum",
                value=round(force, 2),
            )
        )
        if scale != 1.0:
            force *= scale
            steps.append(Provenance(source="constraint", id=scale_reason, value=f"x {scale:g}"))
    if force < floor:
        force = floor
        steps.append(Provenance(source="geometry", id="no-slip floor", value=round(floor, 2)))
    if force > cap:
        force = cap
        steps.append(Provenance(source="geometry", id="fragility cap", value=round(cap, 2)))
    return ForceChoice(
        force=min(MAX_FORCE, max(MIN_FORCE, force)),
        floor=floor,
        cap=cap,
        mass=mass,
        friction=friction,
        provenance=tuple(steps),
    )
