"""Where the region, the type, the force and the depth of a grasp come from before geometry has its say.

Order (ledger G22, A4.8): what worked earlier in this episode, then the retrieved experiences, best first, then what the
perceived affordance suggests. The baselines of the benchmark replace this chain by a heuristic or by fixed defaults.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from kb.experience import ApproachClass, Experience, Retrieval, Strategy
from kb.grasp import DEFAULT_STANDOFF, MAX_APERTURE
from kb.percept import PerceivedObject
from kb.switches import Switches
from kb.vocabulary import GraspType, ProvenanceSource, Region
from sim.quality import TYPE_MATCH
from tools.planning.candidate import WIDEST_GRIP, approach_class
from tools.planning.remembered import RememberedGrasp

DEFAULT_FORCE = 20.0
"""Force of the fixed defaults [N] (ledger G20)."""


@dataclass(frozen=True)
class GraspPrior:
    """One suggestion of how to hold the object; None where it says nothing."""

    source: ProvenanceSource
    id: str
    region: Region | None = None
    type: GraspType | None = None
    approach: ApproachClass | None = None
    tilt: float | None = None
    force: float | None = None
    force_band: tuple[float, float] | None = None
    depth: float | None = None
    aperture: float | None = None
    standoff: float = DEFAULT_STANDOFF
    speed: float = 1.0
    mass: float | None = None
    """Mass learnt with the same category [kg]."""


def prior_chain(
    subject: PerceivedObject,
    retrieval: Retrieval | None,
    memory: RememberedGrasp | None,
    switches: Switches,
    exclude: tuple[str, ...] = (),
) -> tuple[GraspPrior, ...]:
    """Suggestions in the order in which they're tried; never empty.

    Args:
        subject: The target as perceived.
        retrieval: What HAA-RAG returned, or None.
        memory: An earlier success in this episode, or None.
        switches: Which source is live.
        exclude: Ids of experiences that a correction has used up.
    """
    if switches.prior == "heuristic":
        return (heuristic_prior(subject),)
    if switches.prior == "default":
        return (fixed_default(),)
    if switches.prior == "geometry":
        return (GraspPrior(source="geometry", id="no prior"),)
    chain: list[GraspPrior] = []
    if memory is not None and memory.source not in exclude and switches.memory:
        chain.append(from_memory(memory, subject.category))
    for item in retrieval.top if retrieval else ():
        if item.experience.success and item.experience.id not in exclude:
            chain.append(from_experience(item.experience, same_category=item.s_cat >= 1.0))
    chain.append(affordance_prior(subject))
    return tuple(chain)


def from_experience(experience: Experience, *, same_category: bool) -> GraspPrior:
    """The suggestion of an experience; its mass counts for the same category only."""
    return from_strategy(experience.strategy, "experience", experience.id, experience.mass if same_category else None)


def from_memory(memory: RememberedGrasp, category: str) -> GraspPrior:
    """The suggestion of an earlier success; its mass counts for the same category only."""
    return GraspPrior(
        source="memory",
        id=memory.source,
        region=memory.region,
        type=memory.type,
        approach=approach_class(memory.tilt),
        tilt=memory.tilt,
        force=memory.force,
        depth=memory.depth,
        aperture=memory.aperture,
        standoff=memory.standoff,
        speed=memory.speed,
        mass=memory.mass if memory.category == category else None,
    )


def from_strategy(strategy: Strategy, source: ProvenanceSource, id_: str, mass: float | None) -> GraspPrior:
    """A stored strategy as a suggestion."""
    return GraspPrior(
        source=source,
        id=id_,
        region=strategy.region,
        type=strategy.type,
        approach=strategy.approach,
        tilt=strategy.tilt,
        force=strategy.force,
        force_band=strategy.force_band,
        depth=strategy.depth,
        aperture=strategy.aperture,
        standoff=strategy.standoff,
        speed=strategy.speed,
        mass=mass,
    )


def affordance_prior(subject: PerceivedObject) -> GraspPrior:
    """What the perceived affordance descriptor alone suggests: its region and the best type for it (ledger G15)."""
    kind = subject.affordance.type
    match = TYPE_MATCH[kind]
    tool = kind == "TOOL_HANDLE"
    return GraspPrior(
        source="geometry",
        id=f"affordance {kind}",
        region=subject.affordance.region,
        type=max(match, key=lambda type_: match[type_]),
        approach="tilted" if tool else None,
        tilt=math.radians(40.0) if tool else None,
    )


def heuristic_prior(subject: PerceivedObject) -> GraspPrior:
    """Size and fragility alone decide (the paper's heuristic baseline, ledger G21): no experience, no affordance."""
    long, short, high = subject.size
    force = 5.0 + 25.0 * (1.0 - subject.affordance.fragility)
    if short > WIDEST_GRIP and subject.part("rim") is not None:
        return GraspPrior(source="default", id="heuristic: wide and open", region="rim", type="pinch", force=force)
    if high > 1.5 * max(long, short) and high > 0.10:
        return GraspPrior(source="default", id="heuristic: tall", type="side", approach="side", force=force)
    type_: GraspType = "pinch" if short < 0.035 else "power"
    return GraspPrior(source="default", id="heuristic: low", type=type_, approach="top", force=force)


def fixed_default() -> GraspPrior:
    """The fixed defaults of ledger G20: centroid, straight down, minor axis, open hand, 20 N, power."""
    return GraspPrior(
        source="default",
        id="fixed default",
        region="body",
        type="power",
        approach="top",
        tilt=0.0,
        force=DEFAULT_FORCE,
        depth=0.5,
        aperture=MAX_APERTURE,
    )
