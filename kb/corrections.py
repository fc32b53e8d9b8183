"""The correction rules of the reflection as data: one rule per failure type (Sec. IV-B; ledger G18, G19).

A rule says what to change, not how to find the new value: a step that needs geometry (another yaw, the region's
centroid) is named as an action that the tool carries out.
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Literal, get_args

import yaml
from pydantic import Field

from kb.base import Finite, Noun
from kb.errors import BadInputError
from kb.grasp import GraspField
from kb.vocabulary import FAILURE_TYPES, FailureType, GraspType

CorrectionLevel = Literal[1, 2, 3]

RuleAction = Literal[
    "recentre_on_region",
    "tilt_towards_base",
    "next_yaw",
    "approach_vertical",
    "other_region_if_fully_open",
    "quarter_turn",
    "antipodal_yaw",
    "next_type",
    "lower_if_squeezed_out",
    "ground_again",
    "widen_margins",
    "shorten_path",
    "next_experience",
]
"""Steps of a rule that need the scene's geometry or the knowledge base."""

MAX_RETRIES = 3
"""R_max (Sec. IV-A): attempts 0..3."""
TYPE_ROTATION: tuple[GraspType, ...] = ("power", "pinch", "side")
"""Level 2 rotates the grasp type in this order, as a cycle (Sec. IV-B; ledger G19b)."""
LEVEL2_FORCE_SCALE = 0.9
"""Level 2 lowers the force by 10 % (Sec. IV-B)."""
LEVEL3_NOISE = 0.01
"""Level 3 perturbs the position by U(-0.01, 0.01)^3 [m] (Sec. IV-B)."""


class CorrectionRule(Noun):
    """Level-1 correction of one failure type."""

    failure: FailureType
    name: str
    """Short text for provenance, e.g. "slip: force x 1.2"."""
    scale: dict[GraspField, Finite] = Field(default_factory=dict[GraspField, Finite])
    """Field -> factor."""
    add: dict[GraspField, Finite] = Field(default_factory=dict[GraspField, Finite])
    """Field -> summand [SI]."""
    set: dict[GraspField, Finite] = Field(default_factory=dict[GraspField, Finite])
    """Field -> value."""
    actions: tuple[RuleAction, ...] = ()
    amount: Finite | None = None
    """Size of the action: tilt [rad], lowering [m], or factor of the margins."""


@cache
def correction_rules() -> dict[FailureType, CorrectionRule]:
    """All 14 rules, in the order of the taxonomy.

    Raises:
        BadInputError: if the data lack a failure type.
    """
    text = resources.files("kb").joinpath("data", "corrections.yaml").read_text(encoding="utf-8")
    rows = yaml.safe_load(text)["rules"]
    missing = [name for name in FAILURE_TYPES if name not in rows]
    if missing:
        raise BadInputError(f"no correction rule for {', '.join(missing)}", where="corrections.yaml")
    return {name: CorrectionRule.model_validate({"failure": name, **rows[name]}) for name in FAILURE_TYPES}


def correction_rule(failure: FailureType) -> CorrectionRule:
    """The level-1 rule of one failure type."""
    return correction_rules()[failure]


def level_of_attempt(attempt: int, levels: Literal["resolved", "as_written"] = "resolved") -> CorrectionLevel:
    """Correction level used to prepare attempt number `attempt` (1, 2, 3, ...).

    `resolved`: the level is the attempt's own number, so that every level is reached (ledger G19). `as_written`: the
    level belongs to the attempt that failed (r <= 1: 1, r = 2: 2, r = 3: 3), so that level 3 is never executed.
    """
    if attempt < 1:
        raise BadInputError(f"attempt {attempt} is not a retry; retries count from 1")
    index = attempt if levels == "resolved" else max(1, attempt - 1)
    clipped = min(3, index)
    return get_args(CorrectionLevel)[clipped - 1]
