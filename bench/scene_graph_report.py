"""Measure scene graph and constraint inference: `python -m bench.scene_graph_report`.

Scenes: random ones in four arrangements, things leaning and lying inside others, and every built-in scene. What is built
from the pictures is compared with the same relations and constraints computed from the simulator's truth
(`bench.true_relations`). Every object that is missed or made up counts with all its edges. Tuning used seeds
10000-18999 only.
"""

from __future__ import annotations

import argparse
import json
import logging
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bench.relation_scenes import contained_scene, leaning_scene
from bench.true_relations import TrueThing, true_graph
from kb.percept import Percept
from kb.scene_graph import SceneGraph
from kb.vocabulary import RELATIONS
from sim.draw_scene import draw_scene
from sim.placed import PlacedObject, PlacedScene
from sim.pose import rotation_of
from sim.scene_file import builtin_scenes, load_scene
from sim.tasks.random_scene import ARRANGEMENTS, random_scene
from sim.world import World
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.context import ToolContext
from tools.infer_constraints import ConstraintArgs, infer_constraints
from tools.oracle_perception import OraclePerceiver
from tools.perceive import PerceiveArgs
from tools.perception.rgbd_perceiver import RgbdPerceiver

log = logging.getLogger(__name__)

FIRST, COUNT = 19000, 200
"""Acceptance seeds, and how many scenes."""
KINDS = (*ARRANGEMENTS, "leaning", "contained", "builtin")
TARGET = 0.95
"""Least precision and recall that the project promises."""
NEAR = 0.03
"""A reported object is a true one if their centres are at most this, or 0.3 of the true extent, apart [m]."""

TRUE_POINTS = 12_000
"""Samples of each object's true surface: 2-3 mm apart on the largest one. With fewer, near things would not touch, and
what stands in front would be full of holes in the rasterised view."""


@dataclass
class Comparison:
    """Counts of one scene: (name, outcome) -> how often, outcome "hit", "false" or "missed"."""

    seed: int
    scene: str
    edges: Counter[tuple[str, str]] = field(default_factory=Counter)
    found_edges: Counter[tuple[str, str]] = field(default_factory=Counter)
    """The same between objects that were found: what is left when perception missed and made up nothing."""
    constraints: Counter[tuple[str, str]] = field(default_factory=Counter)
    mistakes: list[str] = field(default_factory=list)


def draw(seed: int) -> PlacedScene:
    """The scene of a seed; the kinds take turns."""
    kind = KINDS[seed % len(KINDS)]
    rng = np.random.default_rng(seed)
    if kind == "leaning":
        return leaning_scene(rng)
    if kind == "contained":
        return contained_scene(rng)
    if kind == "builtin":
        names = builtin_scenes()
        return draw_scene(load_scene(names[seed // len(KINDS) % len(names)]), seed)
    return random_scene(rng, arrangement=kind, free_colours=False)


def run_scene(job: tuple[int, str]) -> Comparison:
    """Builds both graphs of the scene of a seed and compares them."""
    seed, perception = job
    scene = draw(seed)
    world = World(scene, settle=False)
    oracle = OraclePerceiver(world, points=TRUE_POINTS)
    rng = np.random.default_rng([seed, 1])
    views = world.capture(rng)
    perceiver = oracle if perception == "oracle" else RgbdPerceiver(None)
    percept = perceiver.perceive(views, PerceiveArgs())
    things = true_things(world, oracle)
    return compare(seed, scene.name, percept, things)


def true_things(world: World, oracle: OraclePerceiver) -> list[TrueThing]:
    """The free objects of the world as they stand now."""
    surfaces = oracle.surfaces()
    free = [thing for thing in world.placed.objects if not thing.fixed]
    return [_true_thing(thing, surfaces, world) for thing in free]


def _true_thing(thing: PlacedObject, surfaces: dict[str, Any], world: World) -> TrueThing:
    pose = world.data.body(thing.id)
    upright = float(rotation_of(np.array(pose.xquat))[2, 2])
    return TrueThing(
        id=thing.id,
        category=thing.category,
        surface=surfaces[thing.id],
        affordance=thing.affordance,
        state=thing.state,
        hollow=any(part.region == "rim" for part in thing.parts) and all(p.region != "neck" for p in thing.parts),
        tilt=float(np.arccos(np.clip(upright, -1.0, 1.0))),
    )


def compare(seed: int, name: str, percept: Percept, things: list[TrueThing]) -> Comparison:
    """Counts agreeing and disagreeing edges and constraints, object by object."""
    result = Comparison(seed, name)
    graph, truth = build_scene_graph(SceneGraphArgs(percept=percept), ToolContext()), true_graph(things)
    names = match(percept, things)
    seen = {(names[e.source], e.relation, names[e.target]) for e in graph.edges}
    real = {(e.source, e.relation, e.target) for e in truth.edges}
    _count(result.edges, {(r, (a, b)) for a, r, b in seen}, {(r, (a, b)) for a, r, b in real}, result.mistakes, result)
    found = set(names.values()) & {thing.id for thing in things}
    both = [{(r, (a, b)) for a, r, b in edges if {a, b} <= found} for edges in (seen, real)]
    _count(result.found_edges, both[0], both[1], [], result)
    for thing in things:
        perceived = next((obj_id for obj_id, true in names.items() if true == thing.id), None)
        wanted = _constraints(truth, thing.id, {t.id: t.id for t in things})
        inferred = set() if perceived is None else _constraints(graph, perceived, names)
        sides = [{(kind, (thing.id, other)) for kind, other in facts} for facts in (inferred, wanted)]
        _count(result.constraints, sides[0], sides[1], result.mistakes, result)
    return result


def match(percept: Percept, things: list[TrueThing]) -> dict[str, str]:
    """Perceived id -> scene id, nearest pairs first; a made-up object keeps its own id with a question mark."""
    pairs = sorted(
        (float(np.linalg.norm(np.subtract(obj.position, thing.centre))), obj.id, thing.id)
        for obj in percept.objects
        for thing in things
    )
    extent = {thing.id: float(np.ptp(thing.surface, axis=0).max()) for thing in things}
    names: dict[str, str] = {}
    for distance, obj_id, thing_id in pairs:
        if obj_id not in names and thing_id not in names.values() and distance <= max(NEAR, 0.3 * extent[thing_id]):
            names[obj_id] = thing_id
    return {obj.id: names.get(obj.id, f"{obj.id}?") for obj in percept.objects}


def _constraints(graph: SceneGraph, target: str, names: dict[str, str]) -> set[tuple[str, str]]:
    found = infer_constraints(ConstraintArgs(graph=graph, target=target), ToolContext()).active
    return {(constraint.kind, names[constraint.target]) for constraint in found}


def _count(
    counts: Counter[tuple[str, str]],
    seen: set[tuple[str, tuple[str, str]]],
    real: set[tuple[str, tuple[str, str]]],
    mistakes: list[str],
    result: Comparison,
) -> None:
    """Adds hits, false and missed facts to the counts, and one line per mistake."""
    for outcome, facts in (("hit", seen & real), ("false", seen - real), ("missed", real - seen)):
        for name, pair in sorted(facts):
            counts[name, outcome] += 1
            if outcome != "hit":
                mistakes.append(f"{result.seed} {result.scene}: {outcome} {pair[0]} {name} {pair[1]}")


def summarise(results: list[Comparison]) -> dict[str, Any]:
    """Counts, precision and recall per relation, per constraint, and over all."""
    edges: Counter[tuple[str, str]] = sum((r.edges for r in results), Counter())
    found: Counter[tuple[str, str]] = sum((r.found_edges for r in results), Counter())
    constraints: Counter[tuple[str, str]] = sum((r.constraints for r in results), Counter())
    kinds = ("support", "occlusion", "content", "collision")
    return {
        "scenes": len(results),
        "relations": {name: _row(edges, [name]) for name in RELATIONS},
        "all_edges": _row(edges, list(RELATIONS)),
        "edges_between_found_objects": _row(found, list(RELATIONS)),
        "constraints": {name: _row(constraints, [name]) for name in kinds},
        "all_constraints": _row(constraints, list(kinds)),
    }


def _row(counts: Counter[tuple[str, str]], names: list[str]) -> dict[str, float]:
    hit, false, missed = (sum(counts[name, outcome] for name in names) for outcome in ("hit", "false", "missed"))
    return {
        "true": hit + missed,
        "precision": hit / (hit + false) if hit + false else float("nan"),
        "recall": hit / (hit + missed) if hit + missed else float("nan"),
    }


def markdown(summary: dict[str, Any], first: int, perception: str) -> str:
    """The report as a table."""
    last = first + summary["scenes"] - 1
    lines = [f"{summary['scenes']} scenes (seeds {first}-{last}), {perception} perception, target {TARGET:.2f}.", ""]
    lines += ["| relation or constraint | true | precision | recall |", "|---|---|---|---|"]
    rows = {**summary["relations"], "**all edges**": summary["all_edges"]}
    rows |= {"edges between found objects": summary["edges_between_found_objects"], **summary["constraints"]}
    rows["**all constraints**"] = summary["all_constraints"]
    lines += [f"| {name} | {r['true']} | {r['precision']:.3f} | {r['recall']:.3f} |" for name, r in rows.items()]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Runs the scenes and writes the table and every mistake."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=FIRST, help="first seed")
    parser.add_argument("--count", type=int, default=COUNT, help="number of scenes")
    parser.add_argument("--perception", choices=["rgbd", "oracle"], default="rgbd")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("results/scene_graph"))
    options = parser.parse_args()
    jobs = [(seed, options.perception) for seed in range(options.first, options.first + options.count)]
    with ProcessPoolExecutor(options.jobs) as pool:
        results = list(pool.map(run_scene, jobs, chunksize=4))
    summary = summarise(results)
    options.out.mkdir(parents=True, exist_ok=True)
    mistakes = [line for result in results for line in result.mistakes]
    (options.out / "mistakes.txt").write_text("\n".join(mistakes) + "\n", encoding="utf-8")
    (options.out / "summary.json").write_text(json.dumps(summary, indent=1), encoding="utf-8")
    table = markdown(summary, options.first, options.perception)
    (options.out / "summary.md").write_text(table, encoding="utf-8")
    log.info("%s", table)


if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    main()
