"""A manipulation experience e = (c, a, g, y, v) of the knowledge base (Sec. III-A) and a retrieved one."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun, Vec3
from kb.vocabulary import FailureType, GraspType, Region

ApproachClass = Literal["top", "tilted", "side"]
"""How the hand arrives: within 20 degrees of vertical, 20-65 degrees off, or flatter."""

SUCCESS_RATE = 0.8
"""y = 1 iff at least this share of the physical trials succeeded."""


class Strategy(Noun):
    """The transferable grasp parameters of an experience: how, not where on the table."""

    region: Region
    """Region that was gripped."""
    type: GraspType
    approach: ApproachClass
    tilt: Finite
    """Angle between the approach and straight down [rad]."""
    force: Finite
    """Force that was commanded [N]."""
    force_band: tuple[Finite, Finite]
    """Forces that succeeded for this strategy in the trials [N]."""
    aperture: Finite
    """Opening before closing [m]."""
    depth: Finite
    """Height of the tool point above the lowest point of the object over the object's height, in [0, 1]."""
    standoff: Finite = 0.10
    speed: Finite = 1.0


class Experience(Noun):
    """One entry of the knowledge base: a strategy with what physics said about it."""

    id: str
    category: str
    affordance: AffordanceDescriptor
    size: Vec3
    """Extents of the object in the trials [m] (longer, shorter, vertical)."""
    mass: Finite
    """Mean mass over the trials [kg], learnt from the lift."""
    strategy: Strategy
    success: bool
    """y: rate >= SUCCESS_RATE."""
    n_trials: int
    n_success: int
    failures: dict[FailureType, int] = Field(default_factory=dict[FailureType, int])
    """How often each failure type occurred among the trials."""
    embedding: tuple[Finite, ...]
    """v: visual embedding of a reference view."""
    embedder: str
    """Name of the embedder that made `embedding`."""
    seeds: tuple[int, int]
    """First and last seed of the trials (0-9999: knowledge-base range)."""


class RetrievedExperience(Noun):
    """An experience with the scores of the three levels of HAA-RAG."""

    experience: Experience
    s_cat: float
    s_aff: float
    s_vis: float
    score: float
    """0.2 s_cat + 0.4 s_aff + 0.4 s_vis, times 0.7 if the experience is a failure."""


class Funnel(Noun):
    """How many entries were left after each level."""

    total: int
    level1: int
    level2: int
    level3: int
    fallback: bool
    """Fewer than three survived level 1, so every entry was admitted with s_cat = 0 (ledger G14b)."""


class Retrieval(Noun):
    """What `retrieve_haarag` returns: the top k, the failures to avoid, and the funnel."""

    top: tuple[RetrievedExperience, ...]
    avoid: tuple[RetrievedExperience, ...] = ()
    """Best-scored failures of the same strategy space, for the reflection (ledger G14f)."""
    funnel: Funnel

    def best(self) -> RetrievedExperience | None:
        """e_1: the best-scored success, or None."""
        return next((item for item in self.top if item.experience.success), None)
