"""The numbers of a perception report: recall, errors and calibration out of compared scenes, as one table."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kb.vocabulary import UNKNOWN_CATEGORY

REGIONS = ("rim", "handle", "stem", "neck")
"""Parts whose local width is measured."""

TARGETS: dict[str, tuple[str, float]] = {
    "recall_separate": (">=", 0.97),
    "recall_touching_stacked": (">=", 0.85),
    "precision": (">=", 0.97),
    "category_accuracy": (">=", 0.93),
    "unknown_auroc": (">=", 0.85),
    "state_accuracy": (">=", 0.95),
    "position_median_mm": ("<=", 2.0),
    "position_p95_mm": ("<=", 6.0),
    "size_median_percent": ("<=", 4.0),
    "width_within_5mm": (">=", 0.95),
    "seconds_per_look": ("<=", 0.25),
}
"""What the project promises."""


@dataclass
class SceneResult:
    """One scene's comparison, as plain rows."""

    seed: int
    rows: list[dict[str, Any]] = field(default_factory=list)
    """One per true object."""
    false_objects: list[dict[str, Any]] = field(default_factory=list)
    """Reported objects that match nothing."""
    seconds: float = 0.0
    """Processor time of the look [s]."""


def summarise(results: list[SceneResult]) -> dict[str, Any]:
    """All numbers of the report."""
    rows = [row for result in results for row in result.rows]
    found = [row for row in rows if row["found"]]
    false = sum(len(result.false_objects) for result in results)
    close = [row for row in rows if row["how"] in ("touching", "stacked")]
    apart = [row for row in rows if row["how"] not in ("touching", "stacked")]
    open_known = [row for row in found if row["category"] != UNKNOWN_CATEGORY and row["visible"] > 0.97]
    open_known = [row for row in open_known if not row["under"]]
    widths = [w for row in found for w in row["widths_mm"].values()]
    positions = [row["position_mm"] for row in found]
    return {
        "scenes": len(results),
        "objects": len(rows),
        "recall_separate": _share(row["found"] for row in apart),
        "recall_touching": _share(row["found"] for row in close if row["how"] == "touching"),
        "recall_stacked_top": _share(row["found"] for row in close if row["how"] == "stacked" and not row["under"]),
        "recall_stacked_base": _share(row["found"] for row in close if row["under"]),
        "recall_touching_stacked": _share(row["found"] for row in close),
        "precision": len(found) / max(len(found) + false, 1),
        "category_accuracy": _share(row["reported"] == row["category"] for row in open_known),
        "category_objects": len(open_known),
        "unknown_auroc": auroc(
            [row["unknown"] for row in found if row["category"] == UNKNOWN_CATEGORY],
            [row["unknown"] for row in found if row["category"] != UNKNOWN_CATEGORY],
        ),
        "known_called_unknown": _share(row["reported"] == UNKNOWN_CATEGORY for row in open_known),
        "unknown_called_unknown": _share(
            row["reported"] == UNKNOWN_CATEGORY for row in found if row["category"] == UNKNOWN_CATEGORY
        ),
        "state_accuracy": _share(
            row["reported_state"] == row["state"]
            for row in found
            if row["state"] != "empty"
            or row["category"] in ("cup", "mug", "bowl", "wine_glass")
            or row["how"] == "stacked"
        ),
        "state_accuracy_all": _share(row["reported_state"] == row["state"] for row in found),
        "position_median_mm": float(np.median(positions)),
        "position_p95_mm": float(np.quantile(positions, 0.95)),
        "size_median_percent": float(np.median([row["size_percent"] for row in found])),
        "size_p95_percent": float(np.quantile([row["size_percent"] for row in found], 0.95)),
        "yaw_median_deg": float(np.median([row["yaw_deg"] for row in found if row["yaw_deg"] is not None] or [0.0])),
        "width_within_5mm": _share(w is not None and w <= 5.0 for w in widths),
        "width_parts": len(widths),
        "width_median_mm": {
            region: float(np.median([row["widths_mm"][region] for row in found if row["widths_mm"].get(region)] or [0]))
            for region in REGIONS
        },
        "part_found": {
            region: _share(row["widths_mm"][region] is not None for row in found if region in row["widths_mm"])
            for region in REGIONS
        },
        "expected_calibration_error": calibration_error(
            [row["confidence"] for row in open_known], [row["reported"] == row["category"] for row in open_known]
        ),
        "visible_error_median": float(np.median([row["visible_error"] for row in found])),
        "seconds_per_look": float(np.median([result.seconds for result in results])),
    }


def _share(values: Any) -> float:
    listed = [bool(value) for value in values]
    return sum(listed) / len(listed) if listed else float("nan")


def auroc(positive: list[float], negative: list[float]) -> float:
    """Probability that a positive scores above a negative (ties count half)."""
    if not positive or not negative:
        return float("nan")
    a, b = np.asarray(positive)[:, None], np.asarray(negative)[None]
    return float(np.mean((a > b) + 0.5 * (a == b)))


def calibration_error(confidence: list[float], right: list[bool], bins: int = 10) -> float:
    """Expected calibration error of stated confidences."""
    c, r = np.asarray(confidence), np.asarray(right, float)
    place = np.clip((c * bins).astype(int), 0, bins - 1)
    return float(sum(abs(c[place == k].mean() - r[place == k].mean()) * (place == k).mean() for k in np.unique(place)))


def markdown(summary: dict[str, Any], first: int) -> str:
    """The report as a table."""
    lines = [
        f"{summary['scenes']} random scenes (seeds {first}-{first + summary['scenes'] - 1}), {summary['objects']} objects.",
        "",
        "| measure | value | target |",
        "|---|---|---|",
    ]
    for key, value in summary.items():
        if isinstance(value, dict):
            value = ", ".join(f"{name} {number:.2f}" for name, number in value.items())
        elif isinstance(value, float):
            value = f"{value:.3f}"
        target = " ".join(str(part) for part in TARGETS.get(key, ("", "")))
        lines.append(f"| {key.replace('_', ' ')} | {value} | {target} |")
    return "\n".join(lines) + "\n"
