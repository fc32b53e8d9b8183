"""Words and facts of the domain. This package exports words only; the store is imported by its own name."""

from kb.affordance import FRAGILE_NEIGHBOUR, AffordanceDescriptor
from kb.constraint import Adjustment, Constraint, Constraints
from kb.errors import BadInputError, EnvironmentFaultError, RagVlmError
from kb.experience import Experience, Funnel, Retrieval, RetrievedExperience, Strategy
from kb.grasp import Grasp, Provenance, Quality
from kb.percept import Part, PerceivedObject, Percept
from kb.rgbd import RgbdView
from kb.run_result import RunResult
from kb.scene_graph import SceneEdge, SceneGraph, SceneNode
from kb.sensing import CameraEvidence, Correction, Evidence, Plan, Sensing
from kb.switches import Switches
from kb.verdict import ObservedAttempt, Verdict

__all__ = [
    "FRAGILE_NEIGHBOUR",
    "Adjustment",
    "AffordanceDescriptor",
    "BadInputError",
    "CameraEvidence",
    "Constraint",
    "Constraints",
    "Correction",
    "EnvironmentFaultError",
    "Evidence",
    "Experience",
    "Funnel",
    "Grasp",
    "ObservedAttempt",
    "Part",
    "PerceivedObject",
    "Percept",
    "Plan",
    "Provenance",
    "Quality",
    "RagVlmError",
    "Retrieval",
    "RetrievedExperience",
    "RgbdView",
    "RunResult",
    "SceneEdge",
    "SceneGraph",
    "SceneNode",
    "Sensing",
    "Strategy",
    "Switches",
    "Verdict",
]
