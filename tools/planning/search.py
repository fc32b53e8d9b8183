"""Best-first search: the best-scored candidates get their clearance measured, the best of those an arm posture."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field

import numpy as np

from kb.by_identity import ByIdentity
from kb.constraint import Constraints
from kb.experience import Strategy
from kb.grasp import Grasp
from kb.percept import PerceivedObject
from kb.sensing import Correction
from sim.hand import FULL_LIFT
from sim.quality import Load
from sim.swept_hand import HAND_RADIUS, Passing, swept_count
from tools.planning.candidate import WIDEST_GRIP, Array
from tools.planning.constrain_candidates import Constrained
from tools.planning.force_choice import ForceTerms
from tools.planning.grasp_prior import GraspPrior
from tools.planning.posture import ArmWay, Posture
from tools.planning.rank_candidates import ROOMY, Ranked, estimate, total_score
from tools.planning.score_bounds import score_bounds
from tools.planning.shape_grasp import narrow_opening, shape_grasp

MEASURED = 150
"""Candidates whose clearance is measured, best first."""
TRIED_POSTURES = 14
"""Candidates for which an arm posture is sought, best first (2 to 4 ms each)."""
FREE = 1.0
"""Clearance reported where nothing is near [m]."""
OWN_CLEARANCE = 0.001
"""Distance of the open hand from the target's own observed points [m]; single noisy points don't count."""
WIDE_MALUS = 0.25
"""Malus of places wider than `WIDEST_GRIP` where a narrower one exists."""

KEPT = 32
"""Clouds of points against which measurements are kept."""
_measures: ByIdentity[dict[tuple[object, ...], tuple[float, float]]] = ByIdentity(KEPT)
_fits: ByIdentity[dict[tuple[object, ...], bool]] = ByIdentity(KEPT)


def _way_of(grasp: Grasp) -> tuple[object, ...]:
    """All that the open hand's way follows from."""
    return grasp.position, grasp.approach, grasp.yaw, grasp.aperture, grasp.standoff


@dataclass
class Search:
    """One planning problem; `best` looks through pools of candidates."""

    subject: PerceivedObject
    constraints: Constraints
    correction: Correction | None
    avoid: tuple[Strategy, ...]
    neighbours_w: Array
    """Points of everything else, shape (N, 3) [m]."""
    own_w: Array
    """Points of the target itself, shape (N, 3) [m]."""
    use_clearance: bool
    way: ArmWay
    spare: int = 2
    """Feasible candidates beyond the best that are looked for, for showing and for a brain to choose from."""
    calm: bool = True
    """Refuse arm postures that are near a singularity."""
    rejected: dict[str, int] = field(default_factory=dict[str, int])
    alternatives: list[tuple[Ranked, Posture]] = field(default_factory=list[tuple[Ranked, Posture]])
    measured: dict[tuple[object, ...], tuple[float, float, float]] = field(
        default_factory=dict[tuple[object, ...], tuple[float, float, float]]
    )
    """Pose -> clearance, opening, and the clearance that was asked for then (a smaller one is only a bound) [m]."""
    unreachable: set[str] = field(default_factory=set[str])

    def best(
        self, pool: list[Constrained], prior: GraspPrior, force: ForceTerms, required: float
    ) -> tuple[Ranked, Posture] | None:
        """The best feasible candidate of `pool`, or None; reasons of the others are counted.

        Args:
            pool: Candidates.
            prior: What they should agree with.
            force: The force to grade them with.
            required: Clearance that they must have [m].
        """
        narrow_exists = any(item.candidate.width <= WIDEST_GRIP for item in pool)
        # With full clearance assumed, a score is an upper bound: the best measured one above all bounds is the best.
        # Most candidates are never looked at again, so the bound is a number and no grasp is made for it.
        affordance = self.subject.affordance
        load = Load.of(force.mass, force.friction, affordance.fragility, affordance.type)
        bounds = score_bounds(pool, prior, force, load, self.avoid, self.correction).tolist()
        heap: list[tuple[float, str, Constrained | Ranked]] = [
            (-self._narrowed(bound, item, narrow_exists), item.candidate.name, item)
            for bound, item in zip(bounds, pool, strict=True)
        ]
        heapq.heapify(heap)
        found: list[tuple[Ranked, Posture]] = []
        measured = postures = 0
        while heap and measured < MEASURED and postures < TRIED_POSTURES and len(found) <= self.spare:
            _, name, ranked = heapq.heappop(heap)
            if name in self.unreachable:
                continue
            if isinstance(ranked, Constrained):
                measured += 1
                known = self._measured(ranked, prior, force, narrow_exists, required)
                if known is not None:
                    heapq.heappush(heap, (-known.score, name, known))
                continue
            postures += 1
            posture = self.way.posture(ranked.grasp, whole=not found, calm=self.calm)
            if posture is None:
                self.unreachable.add(name)
                self._reject("out of the arm's reach")
            else:
                found.append((ranked, posture))
        self.alternatives += found[1:]
        return found[0] if found else None

    def accept_any_posture(self) -> None:
        """From now on restless arm postures will do."""
        self.calm = False
        self.unreachable.clear()

    @staticmethod
    def _narrowed(score: float, item: Constrained, narrow_exists: bool) -> float:
        """The score less the malus of a wide place where there is a narrower one."""
        return score - WIDE_MALUS if item.candidate.width > WIDEST_GRIP and narrow_exists else score

    def _shaped(self, item: Constrained, prior: GraspPrior, force: ForceTerms, opening: float | None) -> Grasp:
        return shape_grasp(item, self.subject, prior, force, self.constraints, self.correction, opening=opening)

    def _measured(
        self, item: Constrained, prior: GraspPrior, force: ForceTerms, narrow_exists: bool, required: float
    ) -> Ranked | None:
        """The candidate with its true clearance, with a narrower opening where that helps; None if it can't be done."""
        narrowest = narrow_opening(item.candidate)
        first = self._shaped(item, prior, force, None)
        clearance, opening = FREE if len(self.neighbours_w) == 0 else ROOMY, first.aperture
        if self.use_clearance and len(self.neighbours_w):
            clearance, opening = self._roomiest(first, narrowest, required)
            if clearance < required:
                self._reject("too close to a neighbour")
                return None
        for width in dict.fromkeys((opening, min(opening, narrowest))):
            grasp = first if width == first.aperture else self._shaped(item, prior, force, width)
            if self._fits_itself(grasp, item.candidate.width):
                free = min(clearance, FREE)
                quality = estimate(self.subject, item.candidate, grasp, free, force.mass, force.friction)
                score = self._narrowed(total_score(quality.q, item, prior, self.avoid, free), item, narrow_exists)
                return Ranked(item=item, grasp=grasp, quality=quality, score=score, clearance=free)
        self._reject("hand would touch another part of the object")
        return None

    def _roomiest(self, grasp: Grasp, narrowest: float, required: float) -> tuple[float, float]:
        """Clearance from the neighbours [m], and the opening with which it is had [m].

        The same pose comes again as another type and in later pools, so what was measured is kept.
        """
        key = (grasp.position, grasp.approach, round(grasp.yaw, 9), grasp.aperture)
        known = self.measured.get(key)
        if known is None or (known[0] < known[2] and known[0] >= required):
            known = (*self._measure(grasp, narrowest, required), required)
            self.measured[key] = known
        return known[0], known[1]

    def _measure(self, grasp: Grasp, narrowest: float, required: float) -> tuple[float, float]:
        """As `_roomiest`, kept as long as these points are: other configurations of the trial ask for the same."""
        key = (*_way_of(grasp), narrowest, required)
        kept = _measures.get((self.neighbours_w,), None, dict[tuple[object, ...], tuple[float, float]])
        if key not in kept:
            kept[key] = self._swept(grasp, narrowest, required)
        return kept[key]

    def _swept(self, grasp: Grasp, narrowest: float, required: float) -> tuple[float, float]:
        offset = self.neighbours_w - np.asarray(grasp.position)
        far = HAND_RADIUS + grasp.standoff + FULL_LIFT + ROOMY
        near = self.neighbours_w[np.einsum("ij,ij->i", offset, offset) < far * far]
        if not len(near):
            return FREE, grasp.aperture
        slim, passing = min(grasp.aperture, narrowest), Passing(grasp, near)
        # Lifting and opening wider only take clearance away, so the cheapest case rules out most.
        least = passing.clearance(slim, 0.0)
        if least < required:
            return least, slim
        wide = passing.clearance(grasp.aperture, FULL_LIFT)
        if wide >= ROOMY:
            return wide, grasp.aperture
        narrow = passing.clearance(slim, FULL_LIFT)
        return (narrow, slim) if narrow > wide + 0.002 else (wide, grasp.aperture)

    def _fits_itself(self, grasp: Grasp, width: float) -> bool:
        """Whether the open hand keeps off the target's own surface on its way."""
        # Things that fill the hand touch the fingers all the way.
        wanted = min(OWN_CLEARANCE, (grasp.aperture - width) / 2 - 0.003)
        if len(self.own_w) < 4:
            return True
        key = (*_way_of(grasp), wanted)
        kept = _fits.get((self.own_w,), None, dict[tuple[object, ...], bool])
        if key not in kept:
            kept[key] = swept_count(grasp, self.own_w, wanted, lift=0.0) < 3
        return kept[key]

    def _reject(self, reason: str) -> None:
        self.rejected[reason] = self.rejected.get(reason, 0) + 1
