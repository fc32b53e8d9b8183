"""The paper's Tables II to V as data (arXiv 2606.31200v1), to be set next to ours in one layout.

Shares are those printed; counts are the integers that reproduce every printed figure (n of 180, 120, 60, 360).
"""

from __future__ import annotations

from dataclasses import dataclass

TRIALS = {"SG": 180, "IT": 120, "LH": 60}
"""Trials per category: 30 for each of 6, 4 and 2 tasks."""


@dataclass(frozen=True)
class ComponentRow:
    """One row of Table II."""

    configuration: str
    """Our name of the configuration."""
    label: str
    """The paper's name."""
    counts: dict[str, int]

    @property
    def total(self) -> int:
        """Successes of 360."""
        return sum(self.counts.values())


TABLE_II = tuple(
    ComponentRow(name, label, dict(zip(("SG", "IT", "LH"), counts, strict=True)))
    for name, label, counts in (
        ("full", "Ours (Full)", (165, 77, 40)),
        ("no_recovery", "w/o Recovery", (114, 40, 14)),
        ("no_memory", "w/o Episodic Memory", (165, 77, 33)),
        ("no_scene_graph", "w/o Scene Graph", (165, 30, 40)),
        ("heuristic", "Heuristic Baseline", (180, 30, 59)),
        ("no_haarag", "w/o HAA-RAG", (90, 0, 0)),
        ("vlm_only", "VLM-Only", (90, 0, 0)),
    )
)
"""Component analysis."""

FIVE_RUNS = {"mean": 0.787, "sd": 0.018, "low": 0.764, "high": 0.810}
"""Full system over five repetitions (Sec. V-B)."""

PER_TASK = {"single_banana": 30, "single_cube": 30, "single_apple": 18, "single_cup": 27}
"""The four task results that the paper prints, of 30."""


@dataclass(frozen=True)
class RecoveryRow:
    """One row of Table III."""

    configuration: str
    category: str
    success: float
    seconds: float


TABLE_III = tuple(
    RecoveryRow(configuration, category, success, seconds)
    for configuration, rows in (
        ("no_recovery", (("SG", 0.633, 1.7), ("IT", 0.333, 2.5), ("LH", 0.233, 5.8))),
        ("full", (("SG", 0.917, 2.3), ("IT", 0.642, 3.5), ("LH", 0.667, 9.1))),
    )
    for category, success, seconds in rows
)
"""Recovery mechanism effectiveness."""
MEAN_ATTEMPTS = 2.48
"""Average attempts for the full system (Sec. V-C)."""
RECOVERED = (114, 192)
"""Recovered trials of those whose first attempt failed, from Table II's counts; the text prints 53.3 %."""


@dataclass(frozen=True)
class RetrievalRow:
    """One row of Table IV."""

    system: str
    """Name of the system in `ragvlm kb eval`."""
    label: str
    p_at_1: float
    p_at_3: float
    mrr: float
    affordance_match: float


TABLE_IV = (
    RetrievalRow("haarag", "HAA-RAG", 0.917, 0.917, 0.917, 0.917),
    RetrievalRow("clip_only", "CLIP-Only", 0.667, 0.667, 0.729, 0.633),
)
"""Retrieval quality on 12 queries against 116 entries."""


@dataclass(frozen=True)
class SceneGraphRow:
    """One row of Table V."""

    configuration: str
    label: str
    success: float
    satisfied: float


TABLE_V = (
    SceneGraphRow("no_scene_graph", "No Scene Graph", 0.250, 0.0),
    SceneGraphRow("no_constraints", "+ Scene Graph", 0.583, 0.0),
    SceneGraphRow("full", "+ Constraints", 0.583, 0.750),
)
"""Scene graph reasoning on the interactive tasks."""
