"""The switches of the ledger as one frozen value that configurations set; not options of the command line."""

from __future__ import annotations

from typing import Literal

from kb.base import Noun


class Switches(Noun):
    """Which reading of the paper is live, and which components take part."""

    retrieval: Literal["haarag", "none", "random_in_category"] = "haarag"
    """Where the prior on region, type and force band comes from; "none": the fixed defaults of ledger G20."""
    prior: Literal["experience", "heuristic", "default", "geometry"] = "experience"
    scene_graph: bool = True
    constraints: bool = True
    recovery: bool = True
    diagnosis_used: bool = True
    """False: `blind_retry`, a fresh draw each attempt."""
    memory: bool = True
    distance: Literal["gap", "centre"] = "gap"
    """How delta_check and delta_safe are measured (ledger G5)."""
    away: Literal["hand_side", "motion"] = "hand_side"
    """Reading of "biases approach direction away" (ledger G11)."""
    levels: Literal["resolved", "as_written"] = "resolved"
    """Index of the correction level (ledger G19)."""
    strict_l1: bool = False
    """Discard unrelated categories without the fallback (ledger G14b)."""
    taxonomy: Literal["known", "blind"] = "known"
    """Superclasses that level 1 knows; "blind": without the names of the far out-of-distribution objects."""
    diagnosis: Literal["observable", "oracle_phi"] = "observable"
    """Source of the failure type (ledger G41)."""
    scope: Literal["trial", "session"] = "trial"
    """Lifetime of the episodic memory (ledger G22)."""
    geometric_candidates: bool = True
    """False: the retrieved parameters are used literally (paper_literal)."""
    clearance: bool = True
    """Score candidates by swept-hand clearance."""
    learn: bool = False
    """Score experiences by their Beta posterior instead of the flat penalty on failures (`--learn`)."""
