"""The paper's Tables II to V with our numbers in the same layout."""

from __future__ import annotations

from collections.abc import Mapping
from statistics import fmean
from typing import Any

from bench.paper_tables import MEAN_ATTEMPTS, RECOVERED, TABLE_II, TABLE_III, TABLE_IV, TABLE_V, TRIALS
from bench.report.recovery import subgoals
from bench.report.results import CATEGORIES, Results, solved
from bench.report.safety import satisfaction
from bench.report.table import Table
from bench.report.times import simulated
from bench.report.value import Content, Count, Number, Points, Share

CAUTION = (
    "The paper's numbers come from its analytical quality model, ours from "
    "{evaluator} with {perception} perception: not the same test."
)


def tables(results: Results, retrieval: Mapping[str, Any] | None = None) -> list[Table]:
    """Tables II, III, V, and IV if an evaluation of the retrieval is at hand.

    Args:
        results: The run.
        retrieval: Content of the file that `ragvlm kb eval --json` writes.
    """
    if not results.twelve:
        return []
    found = [components(results), recovery(results)]
    if retrieval is not None:
        found.append(retrieval_quality(retrieval))
    return [*found, scene_graph(results)]


def _caution(results: Results) -> str:
    first = results.all[0]
    return CAUTION.format(evaluator="MuJoCo" if first.evaluator == "mujoco" else "our analytical model",
                          perception=first.perception)  # fmt: skip


def components(results: Results) -> Table:
    """Table II: success by category, overall, change against Full."""
    rows: list[tuple[Content, ...]] = []
    full = TABLE_II[0]
    for row in TABLE_II:
        own = results.of(row.configuration)
        k, n = solved(own)
        theirs = row.total / 360 - full.total / 360
        ours = _paired(results, row.configuration)
        rows.append(
            (
                row.label,
                *(Share(row.counts[name] / TRIALS[name]) for name in CATEGORIES),
                Share(row.total / 360),
                Points(theirs) if row is not full else None,
                *(_share(results, row.configuration, name) for name in CATEGORIES),
                Count(k, n),
                ours if row is not full else None,
            )
        )
    names = tuple(CATEGORIES)
    return Table(
        "paper_ii",
        "Table II: component analysis, the paper's and ours",
        ("configuration", *(f"{name} paper" for name in names), "all paper", "Δ paper [pp]",
         *(f"{name} ours" for name in names), "all ours", "Δ ours [pp]"),
        tuple(rows),
        f"Δ ours: on the trials that both ran. {_caution(results)}{_no_model(results)}",
        frozenset({full.label}),
    )  # fmt: skip


def _paired(results: Results, configuration: str) -> Points | None:
    """How much better than full it is on the trials that both ran; None without such trials."""
    full = {t.pair: t.success for t in results.of("full")}
    leads = [t.success - full[t.pair] for t in results.of(configuration) if t.pair in full]
    return Points(sum(leads) / len(leads)) if leads else None


def _no_model(results: Results) -> str:
    """The paper's row of that name asked a vision-language model; ours may not have."""
    own = results.of("vlm_only")
    if not own or any(t.brain != "rules" for t in own):
        return ""
    return " No vision-language model took part: our VLM-Only is the fixed default grasp at what was perceived."


def _share(results: Results, configuration: str, category: str) -> Share | None:
    k, n = solved(results.of(configuration, CATEGORIES[category]))
    return Share(k / n) if n else None


def recovery(results: Results) -> Table:
    """Table III: success and time without and with recovery, attempts and recovery rate."""
    rows: list[tuple[Content, ...]] = []
    for row in TABLE_III:
        own = [t for t in results.of(row.configuration, CATEGORIES[row.category]) if t.harness_error is None]
        label = "w/ Recovery" if row.configuration == "full" else "w/o Recovery"
        rows.append(
            (
                f"{label}, {row.category}",
                Share(row.success),
                Number(row.seconds, 1),
                Count(*solved(results.of(row.configuration, CATEGORIES[row.category]))),
                Number(fmean(map(simulated, own)), 1) if own else None,
                Number(fmean(t.times_s.get("total", 0.0) for t in own), 1) if own else None,
            )
        )
    full = results.of("full")
    goals = [goal for goal in subgoals(full) if goal.attempts]
    failed = [t for t in full if t.first_failed]
    rate = Count(sum(t.success for t in failed), len(failed))
    mean = f"{sum(len(goal.attempts) for goal in goals) / len(goals):.2f}" if goals else "–"
    return Table(
        "paper_iii",
        "Table III: recovery, the paper's and ours",
        ("method", "success paper", "time paper [s]", "success ours", "simulated grasping [s]", "wall [s]"),
        tuple(rows),
        f"Recovered trials: paper {Count(*RECOVERED)} by its own counts (printed 53.3 %), ours {rate}. Attempts: paper "
        f"{MEAN_ATTEMPTS} on average, ours {mean} per sub-goal. Wall: what a trial alone takes, without opening the world. The paper does not say which time it "
        f"means. {_caution(results)}",
    )


def retrieval_quality(found: Mapping[str, Any]) -> Table:
    """Table IV: retrieval quality; every system that was evaluated."""
    systems: Mapping[str, Mapping[str, float]] = found.get("systems", {})
    measures = ("p_at_1", "p_at_3", "mrr", "affordance_match")
    printed = {row.system: row for row in TABLE_IV}
    rows: list[tuple[Content, ...]] = []
    for name in [*printed, *sorted(set(systems).difference(printed))]:
        paper, ours = printed.get(name), systems.get(name, {})
        own = [Number(ours[key], 3) if key in ours else None for key in (*measures, "r_func_p_at_1")]
        theirs = [Number(getattr(paper, key), 3) if paper else None for key in measures]
        rows.append((paper.label if paper else name, *theirs, *own))
    return Table(
        "paper_iv",
        "Table IV: retrieval quality, the paper's and ours",
        ("system", "P@1 paper", "P@3 paper", "MRR paper", "match paper", "P@1", "P@3", "MRR", "match", "works P@1"),
        tuple(rows),
        f"Ours: {found.get('queries', '?')} queries. Relevance by affordance is what HAA-RAG sorts by; “works” asks "
        "instead whether the retrieved strategy lifts the object in at least 7 of 10 physical trials.",
    )


def scene_graph(results: Results) -> Table:
    """Table V: success and constraint satisfaction on the interactive tasks."""
    rows: list[tuple[Content, ...]] = []
    for row in TABLE_V:
        own = results.of(row.configuration, CATEGORIES["IT"])
        rows.append((row.label, Share(row.success), Share(row.satisfied), Count(*solved(own)), satisfaction(own)))
    return Table(
        "paper_v",
        "Table V: scene graph on the interactive tasks, the paper's and ours",
        ("configuration", "success paper", "satisfied paper", "success ours", "satisfied ours"),
        tuple(rows),
        "The paper counts no satisfaction where there is no analyzer; we measure it physically in every row. "
        f"{_caution(results)}",
    )
