"""The tools without the agent: every step of the loop is a typed function that you can call yourself.

python examples/tools_alone.py
"""

import numpy as np

from kb.sensing import Evidence
from kb.shape_colour import ShapeColourEmbedder
from kb.store import ExperienceStore
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.classify_failure import ClassifyArgs, classify_failure
from tools.context import ToolContext
from tools.execute_grasp import ExecuteArgs, execute_grasp
from tools.infer_constraints import ConstraintArgs, infer_constraints
from tools.open_world import open_perceiver, open_world
from tools.perceive import PerceiveArgs, perceive
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag


def main() -> None:
    """Looks, retrieves, infers, plans, grasps and diagnoses; prints what each step returned."""
    opened = open_world("phone_near_wine_glass", seed=5)
    embedder = ShapeColourEmbedder()
    context = ToolContext(
        robot=opened.robot,
        store=ExperienceStore.open(),
        perceiver=open_perceiver("rgbd", opened, embedder),
        embedder=embedder,
        rng=np.random.default_rng(5),
    )

    percept = perceive(PerceiveArgs(look=0), context)
    for thing in percept.objects:
        size = " x ".join(f"{side * 1000:.0f}" for side in thing.size)
        print(
            f"{thing.id}: {thing.colour_name} {thing.category} ({thing.confidence:.2f}), {size} mm, {thing.affordance}"
        )
    target = next(thing for thing in percept.objects if thing.category == "smartphone")

    retrieval = retrieve_haarag(
        RetrieveArgs(category=target.category, affordance=target.affordance, embedding=target.embedding), context
    )
    for item in retrieval.top:
        print(
            f"{item.experience.id}: {item.score:.3f}, {item.experience.strategy.region}, {item.experience.strategy.type}"
        )

    graph = build_scene_graph(SceneGraphArgs(percept=percept, target=target.id), context)
    constraints = infer_constraints(ConstraintArgs(graph=graph, target=target.id), context)
    for constraint in constraints.active:
        print(f"{constraint.kind}: {constraint.reason}")

    outcome = plan_grasp(
        PlanArgs(percept=percept, target=target.id, retrieval=retrieval, constraints=constraints), context
    )
    print(outcome.reason)
    if outcome.plan is None:
        return
    sensing = execute_grasp(ExecuteArgs(plan=outcome.plan, percept=percept, target=target.id), context)
    diagnosis = classify_failure(
        ClassifyArgs(
            plan=outcome.plan,
            evidence=Evidence(sensing=sensing),
            constraints=constraints,
            target=target,
            percept=percept,
        ),
        context,
    )
    print("the robot believes:", "success" if diagnosis.claimed else diagnosis.failure, *diagnosis.reasons, sep="\n  ")


if __name__ == "__main__":
    main()
