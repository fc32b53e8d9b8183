"""The report of the learning study: growth curve, difference to the shipped knowledge base, honesty of promotions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.report.learning import growth_chart
from bench.statistics import wilson
from kb.learned import LearnedBase

if TYPE_CHECKING:
    from bench.learn_study import Asked, Taken

BLOCK = 50
"""Trials of a point on the growth curve."""
WORKS = 0.5
"""A promotion was wrong if its strategy, executed afterwards, succeeds less often than this."""
RESAMPLES = 5000


def difference(learner: Sequence[Taken], shipped: Sequence[Taken]) -> tuple[float, float, float]:
    """Learner minus shipped in success over the same worlds, with its 95 % bootstrap interval over trials."""
    count = min(len(learner), len(shipped))
    deltas = np.array(
        [float(a.success) - float(b.success) for a, b in zip(learner[:count], shipped[:count], strict=True)]
    )
    rng = np.random.default_rng(0)
    means = deltas[rng.integers(0, count, (RESAMPLES, count))].mean(axis=1)
    low, high = np.quantile(means, (0.025, 0.975))
    return float(deltas.mean()), float(low), float(high)


def growth(rows: Sequence[Taken]) -> list[dict[str, float]]:
    """Success and attempts by blocks of trials."""
    points: list[dict[str, float]] = []
    for start in range(0, len(rows), BLOCK):
        block = rows[start : start + BLOCK]
        points.append(
            {
                "trials": start + len(block),
                "success": sum(row.success for row in block) / len(block),
                "attempts": sum(row.attempts for row in block) / len(block),
                "entries": block[-1].entries,
            }
        )
    return points


def promotions(base: LearnedBase, learner: Sequence[Taken]) -> list[dict[str, Any]]:
    """Every promotion with what the observer says afterwards: its strategy executed ten times on the object."""
    from bench.kb_eval.relevance import TRIALS, successes

    truth = {row.seed: row for row in learner}
    found: list[dict[str, Any]] = []
    for change in base.journal.changes:
        if change.kind != "promoted" or change.entry is None or not change.entry.success:
            continue
        lessons = [
            other.lesson
            for other in base.journal.changes[: change.version]
            if other.lesson is not None and other.lesson.key == change.key and other.lesson.success
        ]
        behind = [truth[lesson.seed] for lesson in lessons if lesson.seed in truth]
        models = [row.model for row in behind]
        model = max(set(models), key=models.count) if models else ""
        found.append(
            {
                "entry": change.key,
                "model": model,
                "version": change.version,
                "counted": len(behind),
                "false": sum(not (row.success and row.truly_again) for row in behind),
                "executed": successes(model, change.entry.strategy) / TRIALS if model else None,
            }
        )
    return found


def write_report(asked: Asked, learner: Sequence[Taken], shipped: Sequence[Taken], out: Path) -> str:
    """Writes summary.json, growth.svg and report.md; returns the report."""
    made = promotions(LearnedBase.open(out / "learner" / "kb"), learner)
    wrong = [row for row in made if row["executed"] is not None and row["executed"] < WORKS]
    mean, low, high = difference(learner, shipped)
    summary = {
        "asked": asked.model_dump(mode="json"),
        "learner": {"n": len(learner), "successes": sum(row.success for row in learner), "growth": growth(learner)},
        "shipped": {"n": len(shipped), "successes": sum(row.success for row in shipped), "growth": growth(shipped)},
        "difference": {"value": mean, "low": low, "high": high},
        "claims": sum(row.claimed for row in learner),
        "false_claims": sum(row.claimed and not row.success for row in learner),
        "promotions": made,
        "wrong_promotions": len(wrong),
        "refused": sum(len(row.refused) for row in learner),
        "errors": [row.error for row in (*learner, *shipped) if row.error],
    }
    (out / "summary.json").write_text(json.dumps(summary, indent=2) + "\n")
    (out / "growth.svg").write_text(growth_chart(summary))
    text = _text(summary)
    (out / "report.md").write_text(text)
    return text


def _text(summary: dict[str, Any]) -> str:
    asked, gap = summary["asked"], summary["difference"]
    lines = [f"# Learning from nothing: {asked['trials']} trials, {asked['evaluator']}, {asked['perception']}", ""]
    for name in ("learner", "shipped"):
        arm = summary[name]
        band = wilson(arm["successes"], arm["n"])
        share = 100 * arm["successes"] / arm["n"]
        lines.append(
            f"- {name}: {arm['successes']}/{arm['n']} = {share:.1f} % [{100 * band.low:.1f}, {100 * band.high:.1f}]"
        )
    lines.append(f"- difference: {100 * gap['value']:+.1f} points [{100 * gap['low']:+.1f}, {100 * gap['high']:+.1f}]")
    lines.append(f"- claims: {summary['claims']}, false {summary['false_claims']} (injected {asked['false_claims']:g})")
    wrong = summary["wrong_promotions"]
    lines.append(
        f"- promotions: {len(summary['promotions'])}, wrong (executed afterwards, under half succeed): {wrong}; refused {summary['refused']}"
    )
    counted = sum(row["counted"] for row in summary["promotions"])
    lines.append(f"- lifts behind promotions: {counted}, false {sum(row['false'] for row in summary['promotions'])}")
    lines += ["", "![Success and attempts against trials seen](growth.svg)"]
    lines += ["", "| trials | success | attempts | entries | success, shipped |", "|---:|---:|---:|---:|---:|"]
    for mine, other in zip(summary["learner"]["growth"], summary["shipped"]["growth"], strict=False):
        words = (f"{mine['trials']}", f"{100 * mine['success']:.0f} %", f"{mine['attempts']:.2f}", f"{mine['entries']}")
        lines.append(f"| {' | '.join(words)} | {100 * other['success']:.0f} % |")
    return "\n".join(lines) + "\n"
