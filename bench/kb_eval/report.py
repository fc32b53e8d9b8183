"""The evaluation as JSON, Markdown and one HTML page."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from html import escape
from typing import Any

from bench.kb_eval.charts import BLUE, GREEN, RED, dots, tau_chart, weight_chart
from bench.kb_eval.measure_ranking import Mean
from bench.kb_eval.study import NOT_RUN, Part, Study
from bench.report.findings import Finding
from bench.report.page import Section, page
from bench.report.table import Table

PROMISED = ("p_at_1", "p_at_3", "mrr", "affordance_match", "r_func_p_at_1")
"""Keys of every system in the JSON (product promise)."""
COLUMNS = (
    ("p_at_1", "R-aff P@1"), ("p_at_3", "R-aff P@3"), ("mrr", "MRR"), ("affordance_match", "type @3"),
    ("affordance_match_at_5", "type @5"), ("r_func_p_at_1", "R-func P@1"), ("r_func_p_at_3", "R-func P@3"),
    ("r_func_mrr", "R-func MRR"), ("ndcg", "nDCG@10"),
)  # fmt: skip
SPLITS = {
    "in": "the twelve objects of Table I",
    "near": "Near-OOD objects",
    "far": "Far-OOD objects",
    "ood": "all OOD objects",
}


def as_json(study: Study) -> dict[str, Any]:
    """The public format: `systems` and `queries` are the in-distribution queries with perceived descriptors."""
    main = study.part("in") or study.parts[0]
    return {
        "systems": {name: _row(means) for name, means in main.systems.items()},
        "queries": main.queries,
        "not_run": {name: why for name, why in study.embedders.items() if why.startswith(NOT_RUN)},
        "embedders": study.embedders,
        "knowledge_base": study.knowledge_base,
        "perceived": {
            split: {"queries": n, "seen": seen, "category_right": right}
            for split, (n, seen, right) in study.perceived.items()
        },
        "executed": {"pairs": study.executed[0], "missing": study.executed[1], "present_code": study.current},
        "parts": [
            {
                "split": part.split,
                "queries": part.queries,
                "objects": part.objects,
                **asdict(part.setting),
                "systems": {name: _row(means, intervals=True) for name, means in part.systems.items()},
            }
            for part in study.parts
        ],
        "tau_sweep": [_clean(row) for row in study.tau_sweep],
        "weight_sweep": [_clean(row) for row in study.weight_sweep],
        "left_out_tau_sweep": [_clean(row) for row in study.left_out_tau_sweep],
        "left_out_weight_sweep": [_clean(row) for row in study.left_out_weight_sweep],
        "machine": study.machine,
    }


def _row(means: Mapping[str, Mean], *, intervals: bool = False) -> dict[str, Any]:
    row: dict[str, Any] = {key: _number(mean.value) for key, mean in means.items()}
    if intervals:
        row["intervals"] = {
            key: {"queries": [_number(m.low), _number(m.high)],
                  "objects": [_number(m.low_by_object), _number(m.high_by_object)]}
            for key, m in means.items()
        }  # fmt: skip
    return row


def _clean(row: Mapping[str, float]) -> dict[str, float | None]:
    return {key: _number(value) for key, value in row.items()}


def _number(value: float) -> float | None:
    """Six decimals; None where it was not measured."""
    return None if math.isnan(value) else round(value, 6)


def title_of(part: Part) -> str:
    """What a part is, in words."""
    words = [SPLITS[part.split]]
    words.append("true descriptors" if part.setting.true_descriptors else "perceived descriptors")
    if part.split in ("far", "ood"):
        words.append(f"taxonomy {part.setting.taxonomy}")
    if part.setting.leave_out:
        words.append("own category left out")
    return ", ".join(words)


def table_of(part: Part, study: Study) -> Table:
    """All systems and measures of a part."""
    rows = [
        (name.replace("_", " "), *(_cell(means[key]) for key, _ in COLUMNS)) for name, means in part.systems.items()
    ]
    missing = [name for name, why in study.embedders.items() if why.startswith(NOT_RUN)]
    rows += [(f"visual {name}", *([NOT_RUN] + ["–"] * (len(COLUMNS) - 1))) for name in missing]
    name = f"{part.split}-{part.setting.taxonomy}-{part.setting.true_descriptors:d}{part.setting.leave_out:d}"
    return Table(
        name=name,
        title=f"{title_of(part)[0].upper()}{title_of(part)[1:]}: {part.queries} queries",
        columns=("system", *(word for _, word in COLUMNS)),
        rows=tuple(rows),
        note="In brackets: 95 % bootstrap interval over objects. A dash: not measured.",
        emphasis=frozenset({"haa"}),
    )


def _cell(mean: Mean) -> str:
    if math.isnan(mean.value):
        return "–"
    text = f"{100 * mean.value:.1f}"
    if math.isnan(mean.low) or mean.low_by_object == mean.high_by_object:
        return text  # all queries alike: a bootstrap says nothing then
    return f"{text} [{100 * mean.low_by_object:.0f}, {100 * mean.high_by_object:.0f}]"


def findings(study: Study) -> list[Finding]:
    """What is true, in plain words: the targets, and HAA-RAG against the baselines on objects outside the KB."""
    found: list[Finding] = []
    main = study.part("in")
    if main is not None:
        haa = main.systems["haa"]
        for key, word, least in (
            ("p_at_1", "R-aff P@1", 0.96),
            ("mrr", "MRR", 0.97),
            ("r_func_p_at_1", "R-func P@1", 0.9),
        ):
            if not math.isnan(haa[key].value):
                met = haa[key].value >= least
                said = f"HAA-RAG, perceived descriptors: {word} {100 * haa[key].value:.1f} (target {100 * least:.0f})."
                found.append(Finding("shown" if met else "not shown", said))
        rivals = [
            name
            for name in main.systems
            if name != "oracle" and main.systems[name]["p_at_1"].value >= haa["p_at_1"].value
        ]
        others = ", ".join(name.replace("_", " ") for name in rivals if name != "haa")
        if others:
            found.append(
                Finding(
                    "not shown",
                    f"R-aff P@1 does not tell HAA-RAG from {others}: these categories are perceived well enough.",
                )
            )
    for part in study.parts:
        if part.split != "in" and not part.setting.true_descriptors:
            found += [
                _against(part, rival)
                for rival in part.systems
                if rival.startswith("visual_") or rival == "category_only"
            ]
    return found


def _against(part: Part, rival: str) -> Finding:
    """HAA-RAG against one system on R-func P@1 (R-aff where not all was executed), by intervals over objects."""
    haa, theirs = part.systems["haa"], part.systems[rival]
    known = not (math.isnan(haa["r_func_p_at_1"].value) or math.isnan(theirs["r_func_p_at_1"].value))
    key, word = ("r_func_p_at_1", "R-func P@1") if known else ("p_at_1", "R-aff P@1 (not all executed)")
    mine, other = haa[key], theirs[key]
    apart = mine.low_by_object > other.high_by_object
    mark = "shown" if apart else "worse" if mine.value < other.value else "not shown"
    how = "the intervals do not overlap" if apart else "the intervals overlap"
    name = rival.replace("_", " ")
    said = f"{title_of(part)}: {word} {_cell(mine)} with HAA-RAG, {_cell(other)} with {name}; {how}."
    return Finding(mark, said[0].upper() + said[1:])


def markdown(study: Study) -> str:
    """All tables and findings."""
    lines = ["# Retrieval evaluation", "", *_facts_lines(study), ""]
    lines += [f"- {finding.mark}: {finding.words}" for finding in findings(study)]
    lines += ["", *(table_of(part, study).markdown() for part in study.parts)]
    return "\n".join(lines)


def _facts(study: Study) -> dict[str, str]:
    base = study.knowledge_base
    facts = {"Knowledge base": f"{base['entries']} entries, {base['successes']} successes, content {base['content']}"}
    for split, (n, seen, right) in study.perceived.items():
        facts[SPLITS[split][0].upper() + SPLITS[split][1:]] = (
            f"{n} queries, {seen} seen, {right} perceived as their category"
        )
    pairs, missing = study.executed
    by = "" if study.current else ", some by earlier code (--again executes all anew)"
    facts["Executed"] = f"{pairs - missing} of {pairs} pairs of object and strategy, ten trials each{by}"
    facts["Embedders"] = "; ".join(f"{name}: {title}" for name, title in study.embedders.items())
    return facts


def _facts_lines(study: Study) -> list[str]:
    return [f"- {name}: {value}" for name, value in _facts(study).items()]


def html(study: Study) -> str:
    """One page with charts and tables."""
    measures = (("p_at_1", "R-aff P@1", BLUE), ("r_func_p_at_1", "R-func P@1", RED), ("mrr", "MRR", GREEN))
    sections = [
        Section(
            anchor=f"part-{number}",
            title=title_of(part)[0].upper() + title_of(part)[1:],
            lead="R-aff is what HAA-RAG itself sorts by; R-func is executed in physics and favours nobody.",
            charts=[(dots(part.systems, measures, title_of(part)), "Bars: 95 % bootstrap intervals over objects.")],
            tables=[table_of(part, study)],
        )
        for number, part in enumerate(study.parts)
    ]
    sweeps: list[tuple[str, str]] = []
    for words, taus, weights in (
        ("all entries", study.tau_sweep, study.weight_sweep),
        ("own category left out", study.left_out_tau_sweep, study.left_out_weight_sweep),
    ):
        if taus:
            sweeps.append((tau_chart(taus), f"The threshold of level 2, {words}; the paper's is 0.3."))
        for key, measure in (("r_func_p_at_1", "R-func P@1"), ("p_at_1", "R-aff P@1")):
            sweeps.append((weight_chart(weights, key, measure), f"Fusion weights, {words}; the dot is the paper's."))
    sections.append(Section("sweeps", "Threshold and weights", "Nothing was tuned on these queries.", sweeps, ()))
    facts = {escape(name): value for name, value in _facts(study).items()}
    return page(
        "Retrieval evaluation",
        "Does the knowledge base give the right experience?",
        facts,
        (),
        findings(study),
        sections,
    )
