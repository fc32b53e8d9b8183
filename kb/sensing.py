"""What the robot itself senses while it acts: the only basis of its own diagnosis and of `claimed`."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from kb.base import Finite, Noun, Vec2, Vec3
from kb.grasp import Grasp, GraspField, Provenance, Quality
from kb.vocabulary import FailureType

Phase = Literal[
    "plan", "transit", "approach", "close", "lift", "hold", "shake", "carry", "set_down", "release", "retreat", "home"
]
"""Phases of a motion, in order."""


class Sensing(Noun):
    """Readings of one motion, from joint encoders, motor currents, the wrist wrench and the finger encoder."""

    reachable: bool = True
    ik_residual: Finite = 0.0
    """Distance of the best inverse-kinematics solution from the wanted pose [m]."""
    phase: Phase = "home"
    """Last phase that was begun."""
    stopped_by: Literal["force", "timeout", "stop", "unreachable", "path"] | None = None
    """What ended the motion early: the force reflex, the 60-s limit, a person, or planning ("path": no free path)."""
    abort_force: Finite = 0.0
    """Wrist force that triggered the reflex [N]."""
    aimed_at: Vec2 | None = None
    """Where a placing motion set the footprint's centre down [m]: the free place that was chosen."""
    turned: Finite = 0.0
    """By how much a placing motion turned it about the vertical, from how it stood [rad]."""
    lost: bool = False
    """What was held slipped out of the hand on the way to a set-down."""
    abort_direction: Vec3 | None = None
    """Direction of that force on the hand, world frame."""
    approach_force: Finite = 0.0
    """Largest wrist force (bias removed, 10-ms mean) before closing [N]."""
    aperture_commanded: Finite = 0.0
    aperture_start: Finite = 0.0
    """Opening when closing began [m]."""
    aperture_closed: Finite = 0.0
    """Opening when the fingers came to rest [m]."""
    aperture_lifted: Finite = 0.0
    """Opening after the lift [m]."""
    aperture_end: Finite = 0.0
    """Opening after hold and shake [m]."""
    motor_force_closed: Finite = 0.0
    """Finger motor force after closing [N]."""
    motor_force_end: Finite = 0.0
    closing_force_peak: Finite = 0.0
    """Peak of the finger motor force while closing [N]."""
    closing_wrench: Finite = 0.0
    """Largest wrist force while closing [N]: an off-centre grasp pushes the hand."""
    load_lifted: Finite = 0.0
    """Mass that the wrist carries after a 2-cm lift, from the vertical wrist force [kg]."""
    grip_raised: Finite = 0.0
    """By how much the test lift raised the grip because something slipped or was heavy [N]."""
    load_end: Finite = 0.0
    """Mass that the wrist carries at the end [kg]."""
    load_min: Finite = 0.0
    """Smallest 0.1-s mean of the carried mass between lift and end [kg]."""
    load_torque: Finite = 0.0
    """Wrist torque about the tool point at the end [N m]: an off-centre or swinging load."""
    tracking_error: Finite = 0.0
    """Largest distance of the tool point from its path [m]."""
    lift_height: Finite = 0.0
    """How far the tool point rose after closing [m]."""
    held_s: Finite = 0.0
    """Time for which a load was sensed after the lift [s]."""
    sim_time: Finite = 0.0
    """Simulated duration of the motion [s]."""


class CameraEvidence(Noun):
    """What the next look adds: did the target and the others move or vanish, is something in the hand."""

    target_visible: bool = True
    target_moved: Finite = 0.0
    """Displacement of the target on the table [m]."""
    target_tilted: bool = False
    """The object no longer stands as it stood (height or footprint changed)."""
    target_in_hand: bool | None = None
    """An object is seen between the fingers; None where the look was not taken."""
    hand_object_offset: Finite | None = None
    """Distance of the held object from where the grasp plan put it, in the hand's frame [m]."""
    others_moved: dict[str, float] = Field(default_factory=dict)
    """Perceived id -> displacement [m] of other objects that moved more than 5 mm."""
    missing: tuple[str, ...] = ()
    """Other objects that were there before and are no longer seen."""
    deformed: bool = False
    """The held or released object changed its shape."""


class PlaceEvidence(Noun):
    """What a look showed while something was held: which of the places where things stood have become empty."""

    target: Literal["empty", "occupied", "unseen"]
    """Where the target stood; "unseen" where the arm or something else hides it."""
    emptied: tuple[str, ...] = ()
    """Perceived ids of other things that have left their places and are seen nowhere else on the table."""
    unseen: tuple[str, ...] = ()
    """Perceived ids of other things whose places are hidden."""

    @property
    def is_target(self) -> bool:
        """The thing in the hand is the target: its place is empty and no other, or no other thing can be meant."""
        return not self.emptied and (self.target == "empty" or (self.target == "unseen" and not self.unseen))

    @property
    def is_other(self) -> bool:
        """The thing in the hand is not the target: that still stands there, or only another place became empty."""
        return self.target == "occupied" or (self.target == "unseen" and bool(self.emptied))


class Evidence(Noun):
    """All that the diagnosis may use."""

    sensing: Sensing
    camera: CameraEvidence | None = None
    """A look after the motion. Where there is also `places`, what was held has been put back before it."""
    places: PlaceEvidence | None = None
    """A look while something was still held."""


class Correction(Noun):
    """A change of the grasp chosen by the reflection, with the level it belongs to."""

    failure: FailureType
    level: Literal[1, 2, 3]
    rule: str
    """Name of the rule, e.g. "slip: force x 1.2"."""
    changes: dict[GraspField, Finite | str | Vec3] = Field(default_factory=dict[GraspField, Finite | str | Vec3])
    """New values per field."""
    offset: Vec3 = (0.0, 0.0, 0.0)
    """Added to the position that is planned anew [m]: the lowering after a squeeze-out, or level 3's perturbation."""
    region: str | None = None
    """Region to switch to, if the rule says so."""
    exclude: tuple[str, ...] = ()
    """Candidates or experiences not to be used again."""
    avoid_regions: tuple[str, ...] = ()
    """Regions to leave alone if any other can be grasped."""
    weigh: bool = False
    """It slipped or was dropped before: the next lift begins with a test lift that finds the force."""
    reobserve: bool = True
    margin: Finite = 1.0


class Plan(Noun):
    """A planned grasp with the source of every number."""

    grasp: Grasp
    provenance: dict[GraspField, tuple[Provenance, ...]]
    quality: Quality
    region: str
    target: str
    """Perceived id."""
    candidate: str
    """Name of the candidate, unique within the plan's candidates."""
    joints: tuple[Finite, ...] = ()
    """Joint angles at the grasp [rad] (7,)."""
    clearance: Finite = 0.0
    """Smallest distance of the swept hand from anything else [m]."""
    local_width: Finite = 0.0
    """Estimated width between the pads at closing [m]."""
    rejected: dict[str, int] = Field(default_factory=dict)
    """Reason -> number of candidates rejected for it."""
    alternatives: tuple[tuple[Grasp, float, str], ...] = ()
    """Other feasible candidates: grasp, score, name."""
    score: Finite | None = None
    """The planner's score of this candidate, comparable with those of `alternatives`."""
    own_force: Finite | None = None
    """Force that the planner had chosen before a person named another, which nothing may raise [N]; None without."""
