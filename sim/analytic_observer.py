"""The observer of the analytic evaluator: verdicts and constraints from the recorded outcomes."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np

from kb.base import Vec3
from kb.run_result import ConstraintRecord
from kb.verdict import ObservedAttempt, Verdict
from kb.vocabulary import ConstraintKind, FailureType
from sim.analytic_outcome import CONTENT_TILT, SLOW, Outcome
from sim.judge import unmoved
from sim.observer import Observer
from sim.pose import Array, degrees, point_in_world
from sim.recording import Recording
from sim.verdict_constraints import required_targets
from sim.verdict_place import in_bin
from sim.world import World

HELD_S = 4.0
"""Duration of holding and shaking [s]."""


class AnalyticObserver(Observer):
    """Same questions as `sim.observer.Observer`, answered without physics."""

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self._outcomes: dict[int, Outcome] = {}
        self._poses: dict[int, dict[str, list[float]]] = {}

    def on_recording(self, recording: Recording) -> None:
        """Nothing runs in this evaluator."""

    def on_outcome(self, outcome: Outcome) -> None:
        """Keeps what the evaluator said about a motion, and where things are after it."""
        self._outcomes[outcome.attempt] = outcome
        self._poses[outcome.attempt] = {name: [float(v) for v in pose] for name, pose in self.poses().items()}

    @property
    def attempts(self) -> tuple[int, ...]:
        """Numbers of the motions that were evaluated."""
        return tuple(sorted(self._outcomes))

    def judge(
        self, attempt: int, meant: str | None, placement: Any = None, other: str | None = None, *, since: int = 0
    ) -> ObservedAttempt:
        """As `Observer.judge`; its outcomes know no damage that lasts."""
        del since
        self._meant[attempt] = meant
        outcome = self._outcomes.get(attempt)
        if outcome is None or outcome.failure == "UNREACHABLE_POSE":
            return unmoved()
        if outcome.placed is not None:
            return self._judge_placing(outcome, meant, placement, other)
        right = outcome.gripped in (None, meant)
        failure: FailureType | None = outcome.failure if right else "WRONG_OBJECT"
        success = failure is None and outcome.gripped is not None
        held = outcome.failure in (None, "CONSTRAINT_VIOLATION") and outcome.gripped is not None
        harmed = outcome.failure in ("FORCE_DAMAGE", "DEFORMATION")
        touched = tuple(name for name, gap in outcome.clearance.items() if gap <= 0.0 and name not in outcome.supports)
        verdict = Verdict(
            lifted_m=outcome.height if held and right else 0.0,
            held_s=HELD_S if held and right else 0.0,
            slip_m=0.03 if outcome.failure in ("SLIP", "DROP") else 0.0,
            contact=outcome.gripped is not None and outcome.failure not in ("COLLISION", "APPROACH_ANGLE"),
            aperture_m=outcome.width,
            peak_force_n=outcome.force,
            damage=(outcome.gripped,) if harmed and outcome.gripped is not None else (),
            disturbed=touched if outcome.failure == "COLLISION" else (),
            correct_object=right,
        )
        return ObservedAttempt(
            verdict=verdict,
            success=success,
            failure=failure,
            lift_success=success,
            affordance_correct=success,
            strict=success,
        )

    def _judge_placing(self, outcome: Outcome, meant: str | None, placement: Any, other: str | None) -> ObservedAttempt:
        """Whether the thing stands where it was to go."""
        placed = outcome.placed == meant and meant is not None and self._stands(outcome, meant, placement, other)
        verdict = Verdict(
            lifted_m=0.0,
            held_s=0.0,
            slip_m=0.0,
            contact=False,
            aperture_m=0.08,
            peak_force_n=0.0,
            correct_object=outcome.placed == meant,
            placed=placed,
        )
        wrong: FailureType = "POSITION_ERROR" if outcome.placed == meant else "WRONG_OBJECT"
        return ObservedAttempt(verdict=verdict, success=placed, failure=None if placed else wrong)

    def _stands(self, outcome: Outcome, meant: str, placement: Any, other: str | None) -> bool:
        middle = self._middle(outcome.attempt, meant)
        kind = getattr(placement, "kind", "aside")
        if kind == "bin":
            return in_bin(middle, self.placed, 0.1)
        if kind == "lane":
            number, count = placement.lane
            return abs(float(middle[1]) - ((count - 1) / 2 - number) * 0.15) <= 0.075
        if kind in ("beside", "on") and other is not None:
            return float(np.linalg.norm((middle - self._middle(outcome.attempt, other))[:2])) < 0.20
        if kind == "back":
            return float(np.linalg.norm(middle[:2] - self.start[meant][:2])) < 0.04
        return {"left": middle[1] > 0.05, "right": middle[1] < -0.05}.get(getattr(placement, "side", None) or "", True)

    def _middle(self, attempt: int, name: str) -> Array:
        thing = next(thing for thing in self.placed.objects if thing.id == name)
        return point_in_world(self._poses[attempt][name], (0.0, 0.0, thing.size[2] / 2))

    def constraints(self, inferred: Iterable[tuple[ConstraintKind, str]] = ()) -> tuple[ConstraintRecord, ...]:
        """As `Observer.constraints`, from clearances, tilt and order."""
        required, given = list(required_targets(self.placed.task)), list(inferred)
        records = []
        for kind, target in dict.fromkeys([*required, *given]):
            satisfied, measured = self._measure(kind, target)
            records.append(
                ConstraintRecord(
                    kind=kind,
                    target=target,
                    required=(kind, target) in required,
                    inferred=(kind, target) in given,
                    satisfied=satisfied,
                    measured=measured,
                )
            )
        return tuple(records)

    def _measure(self, kind: ConstraintKind, target: str) -> tuple[bool, dict[str, Any]]:
        tried = [o for _, o in sorted(self._outcomes.items()) if o.placed is None and o.failure != "UNREACHABLE_POSE"]
        if not tried:
            return False, {"note": "nothing was attempted"}
        if kind == "content":
            about = [o for o in tried if o.gripped == target]
            tilt, speed = max((o.tilt for o in about), default=0.0), max((o.speed for o in about), default=0.0)
            return tilt <= CONTENT_TILT and speed <= SLOW + 1e-9, {"tilt_deg": degrees(tilt), "speed": speed}
        if kind == "support":
            first = next((o for o in tried if o.gripped is not None and o.gripped != target), None)
            removed = any(o.placed == target for o in self._outcomes.values())
            kept = removed and (first is None or target not in first.supports)
            return kept, {"removed": removed}
        gap = min((o.clearance.get(target, 1.0) for o in tried if o.gripped != target), default=1.0)
        return gap > 0.0, {"clearance_mm": round(gap * 1e3, 2)}

    def meant(self, category: str | None, position: Vec3, attempt: int | None = None) -> str | None:
        """As `Observer.meant`; `attempt` compares with where things were after the motion before it."""
        earlier = [number for number in self.attempts if attempt is not None and number < attempt]
        if attempt is None:
            return super().meant(category, position)
        poses = {n: np.asarray(p) for n, p in self._poses[earlier[-1]].items()} if earlier else self.start
        return self.nearest(category, position, poses)

    def damaged(self, since: int = 0) -> tuple[str, ...]:
        """Objects that were pressed harder than they bear, from motion `since` on."""
        broken = ("FORCE_DAMAGE", "DEFORMATION")
        harmed = {o.gripped for n, o in self._outcomes.items() if n >= since and o.failure in broken}
        return tuple(sorted(name for name in harmed if name is not None))

    def _drop(self, number: int) -> None:
        super()._drop(number)
        for record in (self._outcomes, self._poses):
            record.pop(number, None)

    def state(self) -> bytes:
        """All that was recorded, as bytes."""
        return json.dumps(
            {
                "start": {name: [float(v) for v in pose] for name, pose in self.start.items()},
                "meant": {str(k): v for k, v in self._meant.items()},
                "poses": {str(k): v for k, v in self._poses.items()},
                "outcomes": {str(k): v.model_dump(mode="json") for k, v in self._outcomes.items()},
            }
        ).encode()

    def kept(self) -> tuple[Any, ...]:
        """All that was recorded, as values that nobody changes: for `recall` in this process."""
        return dict(self.start), dict(self._meant), dict(self._poses), dict(self._outcomes)

    def recall(self, known: tuple[Any, ...]) -> None:
        """Puts back what `kept` returned."""
        self.start, self._meant, self._poses, self._outcomes = (dict(part) for part in known)

    def load(self, blob: bytes) -> None:
        """Puts back what `state` returned."""
        kept = json.loads(blob)
        self.start = {name: np.asarray(pose) for name, pose in kept["start"].items()}
        self._meant = {int(k): v for k, v in kept["meant"].items()}
        self._poses = {int(k): v for k, v in kept["poses"].items()}
        self._outcomes = {int(k): Outcome.model_validate(v) for k, v in kept["outcomes"].items()}
