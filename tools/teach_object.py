"""Teach the knowledge base an object of a scene: grasp it some times in physics and keep what happened.

The object is perceived from pixels as ever; how it is held comes from geometry and what is known already. Outcomes are the
observer's, as for every entry that is built (ledger G12), on seeds below 10000.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Noun
from kb.constraint import Constraints
from kb.errors import BadInputError
from kb.experience import SUCCESS_RATE, Experience, Strategy
from kb.percept import PerceivedObject
from kb.vocabulary import FailureType
from tools.confirm_grasp import strategy_of
from tools.context import ToolContext
from tools.execute_grasp import ExecuteArgs, execute_grasp
from tools.open_world import OpenedWorld, open_perceiver, open_world
from tools.perceive import PerceiveArgs, perceive
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag

FIRST_SEED = 9000
"""Seeds of what is taught; the shipped entries use lower ones."""
FEWEST = 3
"""A way of holding that was tried less often makes no entry."""


class TeachArgs(Noun):
    """Arguments of `teach_object`."""

    name: str
    """Category of the new entries."""
    scene: str
    """Built-in name or scene file."""
    object: str
    """Id of the object in the scene."""
    affordance: dict[str, Any] = Field(default_factory=dict)
    """Fields of the descriptor that the person knows better than perception."""
    trials: Annotated[int, Field(ge=10, le=200)] = 10


@dataclass(frozen=True)
class _Tried:
    """One trial."""

    seed: int
    subject: PerceivedObject
    strategy: Strategy
    success: bool
    failure: FailureType | None
    load: float

    @property
    def way(self) -> tuple[str, str, str]:
        return self.strategy.region, self.strategy.type, self.strategy.approach


def teach_object(
    args: TeachArgs, context: ToolContext, progress: Callable[[int, int, str], None] | None = None
) -> list[Experience]:
    """Grasps the object of the scene `trials` times and returns one entry per way of holding; nothing is stored.

    Args:
        args: What to try, and what it is called.
        context: Knowledge base to plan from, embedder and switches.
        progress: Told after every trial.

    Raises:
        BadInputError: the scene has no such object, or it was seen or grasped too seldom.
    """
    tried: list[_Tried] = []
    for number in range(args.trials):
        one = _try(args, FIRST_SEED + number, context)
        if one is not None:
            tried.append(one)
        if progress is not None:
            word = "not seen, or no plan" if one is None else "held" if one.success else str(one.failure)
            progress(number + 1, args.trials, f"{args.name}: {word}")
    counts = Counter(one.way for one in tried)
    ways = [way for way, count in sorted(counts.items()) if count >= FEWEST]
    if not ways:
        raise BadInputError(
            f"{args.object!r} was grasped in {len(tried)} of {args.trials} trials: too few", where=args.scene
        )
    name = context.embedder.name if context.embedder is not None else ""
    return [_entry(args, way, [one for one in tried if one.way == way], name) for way in ways]


def check_object(scene: str, thing: str) -> None:
    """Raises `BadInputError` if the scene has no such object; tells before anything is written."""
    _movable(open_world(scene, FIRST_SEED), scene, thing)


def _movable(opened: OpenedWorld, scene: str, thing: str) -> None:
    ids = [item.id for item in opened.placed.objects if not item.fixed]
    if thing not in ids:
        raise BadInputError(f"the scene has no object {thing!r}", where=scene, choices=ids)


def _try(args: TeachArgs, seed: int, context: ToolContext) -> _Tried | None:
    """One trial; None where the object was not seen or no plan was found."""
    opened = open_world(args.scene, seed)
    _movable(opened, args.scene, args.object)
    tools = ToolContext(
        robot=opened.robot, store=context.store, perceiver=open_perceiver("rgbd", opened, context.embedder),
        embedder=context.embedder, switches=context.switches, rng=np.random.default_rng([seed, 3]), stop=opened.stop,
    )  # fmt: skip
    percept = perceive(PerceiveArgs(), tools)
    subject = next((o for o in percept.objects if opened.observer.meant(o.category, o.position) == args.object), None)
    if subject is None:
        return None
    known = None
    if context.store is not None:
        query = RetrieveArgs(category=args.name, affordance=_descriptor(args, subject), embedding=subject.embedding)
        known = retrieve_haarag(query, tools)
    plan = plan_grasp(
        PlanArgs(percept=percept, target=subject.id, retrieval=known, constraints=Constraints()), tools
    ).plan
    if plan is None:
        return None
    sensed = execute_grasp(ExecuteArgs(plan=plan, percept=percept, target=subject.id), tools)
    seen = opened.observer.judge(opened.motions, args.object)
    failure = None if seen.success else seen.failure or "UNKNOWN"
    return _Tried(seed, subject, strategy_of(plan, subject), seen.success, failure, max(0.0, sensed.load_end))


def _descriptor(args: TeachArgs, subject: PerceivedObject) -> AffordanceDescriptor:
    return AffordanceDescriptor.model_validate({**subject.affordance.model_dump(), **args.affordance})


def _entry(args: TeachArgs, way: tuple[str, str, str], tried: Sequence[_Tried], embedder: str) -> Experience:
    """The entry of all trials that held it one way."""
    good = [one for one in tried if one.success]
    model = good or list(tried)
    middle = model[len(model) // 2]
    forces = [one.strategy.force for one in model]
    strategy = middle.strategy.model_copy(
        update={
            "tilt": round(float(np.mean([one.strategy.tilt for one in model])), 4),
            "force": round(float(np.mean(forces)), 4),
            "force_band": (round(min(forces), 4), round(max(forces), 4)),
            "depth": round(float(np.mean([one.strategy.depth for one in model])), 4),
        }
    )
    failures: Counter[FailureType] = Counter(one.failure for one in tried if one.failure is not None)
    sizes = np.mean([one.subject.size for one in tried], axis=0)
    return Experience(
        id=f"taught-{args.name}-{'-'.join(way)}", category=args.name,
        affordance=_descriptor(args, middle.subject).model_copy(update={"region": strategy.region}),
        size=(round(float(sizes[0]), 4), round(float(sizes[1]), 4), round(float(sizes[2]), 4)),
        mass=round(float(np.mean([one.load for one in model])), 4), strategy=strategy,
        success=len(good) >= SUCCESS_RATE * len(tried), n_trials=len(tried), n_success=len(good),
        failures=dict(sorted(failures.items())),
        embedding=tuple(round(value, 6) for value in middle.subject.embedding), embedder=embedder,
        seeds=(tried[0].seed, tried[-1].seed),
    )  # fmt: skip
