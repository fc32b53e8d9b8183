"""One attempt from a drawn scene to the observer's word, outside the agent: for calibration and for the diagnosis report.

Between planning and moving the plan may be bent on purpose; the robot's own diagnosis is then compared with the truth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from agent.attempt import Attempt, in_hand
from agent.compare_looks import compare_looks
from agent.placing import put_back_args
from kb.constraint import Constraints
from kb.percept import PerceivedObject, Percept
from kb.sensing import Evidence, PlaceEvidence, Plan, Sensing
from kb.switches import Switches
from kb.verdict import ObservedAttempt
from kb.vocabulary import PerceptionName
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.classify_failure import ClassifyArgs, Diagnosis, classify_failure
from tools.context import ToolContext
from tools.diagnosis.held_look import look_at_places, worth_a_look
from tools.execute_grasp import ExecuteArgs, execute_grasp
from tools.infer_constraints import ConstraintArgs, infer_constraints
from tools.open_world import OpenedWorld, open_perceiver, open_world
from tools.perceive import PerceiveArgs, perceive
from tools.place_object import place_object
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag

Bend = Callable[[Plan, Percept, PerceivedObject, np.random.Generator], Plan | None]
"""Changes a plan on purpose; None: this scene doesn't lend itself to it."""


@dataclass(frozen=True)
class Once:
    """What was planned, sensed, diagnosed and observed."""

    plan: Plan | None
    reason: str
    sensing: Sensing | None = None
    diagnosis: Diagnosis | None = None
    """After a further look, where the robot was not sure of success."""
    observed: ObservedAttempt | None = None

    @property
    def success(self) -> bool:
        """The observer's word."""
        return self.observed is not None and self.observed.success


def tools_for(
    opened: OpenedWorld, perception: PerceptionName, store: Any, switches: Switches, seed: int
) -> ToolContext:
    """A context on an opened world."""
    from kb.shape_colour import ShapeColourEmbedder

    embedder = ShapeColourEmbedder()
    return ToolContext(
        robot=opened.robot,
        store=store,
        perceiver=open_perceiver(perception, opened, embedder),
        embedder=embedder,
        switches=switches,
        rng=np.random.default_rng([seed, 17]),
        stop=opened.stop,
    )


def attempt_once(
    scene: str,
    seed: int,
    *,
    perception: PerceptionName = "oracle",
    store: Any = None,
    switches: Switches | None = None,
    bend: Bend | None = None,
) -> Once | None:
    """Draws a scene, plans one grasp of its target, bends it if asked to, carries it out and judges it.

    Args:
        scene: Built-in name or file.
        seed: Seed of the world.
        perception: Which perceiver looks.
        store: Knowledge base; None plans without experience.
        switches: Configuration.
        bend: What to change on purpose.

    Returns:
        All that happened, or None where `bend` found the scene unfit.
    """
    opened = open_world(scene, seed)
    context = tools_for(opened, perception, store, switches or Switches(), seed)
    percept = perceive(PerceiveArgs(), context)
    target = _target(opened, percept)
    if target is None:
        return Once(None, "the target was not seen")
    graph = build_scene_graph(SceneGraphArgs(percept=percept, target=target.id), context)
    constraints = infer_constraints(ConstraintArgs(graph=graph, target=target.id), context)
    retrieval = None
    if store is not None:
        query = RetrieveArgs(category=target.category, affordance=target.affordance, embedding=target.embedding)
        retrieval = retrieve_haarag(query, context)
    args = PlanArgs(percept=percept, target=target.id, retrieval=retrieval, constraints=constraints)
    outcome = plan_grasp(args, context)
    if outcome.plan is None:
        return Once(None, outcome.reason)
    plan: Plan | None = outcome.plan
    if bend is not None:
        plan = bend(outcome.plan, percept, target, np.random.default_rng([seed, 23]))
        if plan is None:
            return None
    return _carried_out(opened, context, percept, target, plan, constraints, outcome.reason)


def _carried_out(
    opened: OpenedWorld,
    context: ToolContext,
    percept: Percept,
    target: PerceivedObject,
    plan: Plan,
    constraints: Constraints,
    reason: str,
) -> Once:
    meant = opened.observer.meant(target.category, target.position)
    sensing = execute_grasp(ExecuteArgs(plan=plan, percept=percept, target=target.id), context)
    observed = opened.observer.judge(opened.motions, meant)
    places: PlaceEvidence | None = None
    args = ClassifyArgs(
        plan=plan, evidence=Evidence(sensing=sensing), constraints=constraints, target=target, percept=percept
    )
    diagnosis = classify_failure(args, context)
    # As the agent does: where it is not sure, or another thing feels the same, it looks while holding.
    if worth_a_look(sensing, percept, target, sure=diagnosis.claimed):
        places = look_at_places(sensing, percept, target, context)
        args = args.model_copy(update={"evidence": Evidence(sensing=sensing, places=places)})
        diagnosis = classify_failure(args, context)
    if not diagnosis.claimed:
        # As the agent does, too: the hand is emptied, and a look precedes the last word on what went wrong.
        failed = Attempt(
            number=0, turn=0, goal=0, level=0, plan=plan, target=target, percept=percept, sensing=sensing, places=places
        )
        _put_back(opened, context, failed)
        after = perceive(PerceiveArgs(look=1, previous=percept), context)
        evidence = Evidence(sensing=sensing, camera=compare_looks(percept, after, target.id), places=places)
        diagnosis = classify_failure(args.model_copy(update={"evidence": evidence}), context)
    return Once(plan, reason, sensing, diagnosis, observed)


def _put_back(opened: OpenedWorld, context: ToolContext, failed: Attempt) -> None:
    """Whatever hangs in the hand goes back onto the table."""
    if opened.robot.holding:
        place_object(put_back_args(failed.model_copy(update={"target": in_hand(failed)})), context)
        if opened.robot.holding:
            opened.robot.release_and_home()


def _target(opened: OpenedWorld, percept: Percept) -> PerceivedObject | None:
    """The perceived object that stands for the scene's target."""
    task = opened.placed.task
    wanted = task.target if task is not None and task.target is not None else opened.placed.objects[0].id
    for seen in percept.objects:
        if opened.observer.meant(seen.category, seen.position) == wanted:
            return seen
    return None
