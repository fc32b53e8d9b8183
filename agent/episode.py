"""Between the state and the episodic memory: what is remembered of a success, and what is recalled for an object."""

from __future__ import annotations

import math
from typing import Literal

from agent.attempt import Attempt
from agent.context import AgentContext
from agent.state import State
from kb.percept import PerceivedObject
from kb.sensing import Plan
from kb.taxonomy import superclass
from memory import EpisodicMemory, HistoryEntry, MemoryItem, recall, remember


def with_success(state: State) -> EpisodicMemory:
    """M with the strategy of the last attempt: how it was grasped, not where it stood (Algorithm 1)."""
    return remember(state.memory, item_of(state.attempts[-1], len(state.tries())))


def item_of(attempt: Attempt, tries: int) -> MemoryItem:
    """The memory item of one successful attempt."""
    grasp, target = attempt.plan.grasp, attempt.target
    height = max(target.size[2], 1e-6)
    return MemoryItem(
        category=target.category,
        affordance=target.affordance,
        superclass=superclass(target.category),
        region=attempt.plan.region,  # pyright: ignore[reportArgumentType]
        type=grasp.type,
        tilt=math.acos(max(-1.0, min(1.0, -grasp.approach[2]))),
        force=unconstrained(attempt.plan, "force"),
        depth=min(1.0, max(0.0, (grasp.position[2] - target.base_z) / height)),
        aperture=grasp.aperture,
        width=attempt.sensing.aperture_end,
        standoff=unconstrained(attempt.plan, "standoff"),
        speed=unconstrained(attempt.plan, "speed"),
        mass=attempt.sensing.load_end,
        attempts=max(1, tries),
        source=f"turn {attempt.turn}, attempt {attempt.number}",
    )


def unconstrained(plan: Plan, name: Literal["force", "standoff", "speed"]) -> float:
    """The number before the neighbours of that moment changed it [N, m, share].

    A neighbour's constraint acts on what is recalled, too: remembering the constrained number would let it act once more
    with every repetition, until the hand starts at the ceiling and presses with nothing.
    """
    steps = plan.provenance.get(name, ())
    sources = [step.source for step in steps]
    if "constraint" not in sources or "correction" in sources:
        return float(getattr(plan.grasp, name))
    given = [step.value for step in steps[: sources.index("constraint")] if isinstance(step.value, int | float)]
    return float(given[-1]) if given else float(getattr(plan.grasp, name))


def recalled(state: State, context: AgentContext, target: PerceivedObject) -> MemoryItem | None:
    """What worked for such an object before, in the lookup order of ledger G22."""
    if not state.memory.items or not context.switches.memory:
        return None
    found = recall(state.memory, target.category, target.affordance, superclass)
    return found.item if found is not None else None


def history(state: State) -> tuple[HistoryEntry, ...]:
    """H: the failed attempts for the goal in work."""
    return tuple(
        HistoryEntry(
            goal=attempt.goal,
            attempt=index,
            grasp=attempt.plan.grasp,
            failure=attempt.failure or "UNKNOWN",
            quality=attempt.plan.quality,
            region=attempt.plan.region,
            candidate=attempt.plan.candidate,
            experiences=tuple(
                dict.fromkeys(
                    item.id
                    for items in attempt.plan.provenance.values()
                    for item in items
                    if item.source == "experience"
                )
            ),
        )
        for index, attempt in enumerate(state.tries())
        if not attempt.claimed
    )
