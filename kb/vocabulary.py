"""The closed vocabularies of the domain, in the paper's words (ledger A1, A3, A5, G6, G17)."""

from __future__ import annotations

from typing import Literal, get_args

AffordanceType = Literal[
    "GRASPABLE_BODY",
    "GRASPABLE_HANDLE",
    "GRASPABLE_EDGE",
    "PINCHABLE",
    "WRAPPABLE",
    "FRAGILE",
    "TOOL_HANDLE",
    "CLAMPABLE",
]
"""The paper's eight affordance types (Sec. III-A)."""

Material = Literal["ceramic", "organic", "plastic", "wood", "glass", "metal", "mixed", "fabric", "foam", "paper"]
"""Materials of Table I, and two that only objects outside the table have."""

Region = Literal["body", "handle", "rim", "edge", "stem", "neck"]
"""Graspable regions implied by the paper (ledger A1.10)."""

GraspType = Literal["power", "pinch", "side"]
"""The paper's grasp types (Sec. III)."""

ObjectState = Literal["empty", "filled", "stacked"]
"""Physical state of a scene-graph node (Sec. III-B). "stacked": the object rests on another one."""

Relation = Literal[
    "ON_TOP_OF",
    "SUPPORTS",
    "CONTAINS",
    "INSIDE",
    "OCCLUDES",
    "OCCLUDED_BY",
    "BEHIND",
    "IN_FRONT_OF",
    "LEFT_OF",
    "RIGHT_OF",
    "ABOVE",
    "BELOW",
    "ADJACENT_TO",
    "TOUCHING",
    "LEANING_ON",
    "BLOCKS_APPROACH",
]
"""The 16 relations (ledger G6): `source relation target`."""

INVERSE: dict[Relation, Relation] = {
    "ON_TOP_OF": "SUPPORTS",
    "SUPPORTS": "ON_TOP_OF",
    "CONTAINS": "INSIDE",
    "INSIDE": "CONTAINS",
    "OCCLUDES": "OCCLUDED_BY",
    "OCCLUDED_BY": "OCCLUDES",
    "BEHIND": "IN_FRONT_OF",
    "IN_FRONT_OF": "BEHIND",
    "LEFT_OF": "RIGHT_OF",
    "RIGHT_OF": "LEFT_OF",
    "ABOVE": "BELOW",
    "BELOW": "ABOVE",
    "ADJACENT_TO": "ADJACENT_TO",
    "TOUCHING": "TOUCHING",
}
"""Inverse of each relation that has one; LEANING_ON and BLOCKS_APPROACH are directed and have none."""

ConstraintKind = Literal["content", "collision", "support", "occlusion"]
"""The four constraint types of Sec. III-B."""

FailureType = Literal[
    "POSITION_ERROR",
    "UNREACHABLE_POSE",
    "APPROACH_ANGLE",
    "WIDTH_MISMATCH",
    "COLLISION",
    "ORIENTATION",
    "SLIP",
    "DROP",
    "FORCE_DAMAGE",
    "DEFORMATION",
    "WRONG_OBJECT",
    "CONSTRAINT_VIOLATION",
    "TIMEOUT",
    "UNKNOWN",
]
"""The 14 failure types, in the order of the paper's four groups (3 + 3 + 4 + 4, Sec. IV-B)."""

GoalKind = Literal["pick", "place", "clear", "sort", "look", "answer"]
ProvenanceSource = Literal["experience", "memory", "constraint", "geometry", "correction", "default"]
BrainName = Literal["rules", "openai", "hf"]
PerceptionName = Literal["rgbd", "vlm", "oracle"]
EvaluatorName = Literal["mujoco", "analytic"]

UNKNOWN_CATEGORY = "unknown"
"""Category of an object that fits no known class."""

AFFORDANCE_TYPES: tuple[AffordanceType, ...] = get_args(AffordanceType)
MATERIALS: tuple[Material, ...] = get_args(Material)
REGIONS: tuple[Region, ...] = get_args(Region)
RELATIONS: tuple[Relation, ...] = get_args(Relation)
FAILURE_TYPES: tuple[FailureType, ...] = get_args(FailureType)
