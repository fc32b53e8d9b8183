"""The retry ladder: budget, level of the attempt being prepared, and when trying again would be dishonest (Sec. IV-B)."""

from __future__ import annotations

from kb.percept import PerceivedObject
from kb.run_result import Level
from kb.sensing import CameraEvidence
from kb.switches import Switches

R_MAX = 3
"""Retries per goal (ledger A4.1); with the first attempt, four."""
MAX_EXTRA_ACTIONS = 3
"""Removals of other objects per instruction, outside the retry budget (ledger G52)."""
MAX_RELOOKS = 1
"""Further looks when planning finds no grasp: the next picture has other noise."""
PLAN_LOOKS = 3
"""The same for a thing whose seen shape offers no grasp: one millimetre decides about an apple as wide as the hand opens."""
BRITTLE = 0.5
"""Things at least this fragile are not tried again once they have fallen over (benchmark section 3: toppling damages)."""


def budget(switches: Switches) -> int:
    """Attempts per goal."""
    return 1 + R_MAX if switches.recovery else 1


def level_of(attempt: int, switches: Switches) -> Level:
    """Correction level of attempt number `attempt` (0 = the first) of a goal.

    "resolved" indexes by the attempt being prepared; "as_written" by the attempt that failed, so that level 3 is never
    reached within the budget (ledger G19).
    """
    if attempt == 0:
        return 0
    r = attempt if switches.levels == "resolved" else attempt - 1
    levels: tuple[Level, ...] = (1, 1, 2, 3)
    return levels[min(r, R_MAX)]


def irreversible(target: PerceivedObject, camera: CameraEvidence | None) -> str | None:
    """Why another attempt would make no sense, or None: the damage that the cameras can see (ledger G46).

    Things that are merely not seen are no proof: the next look may show them (`agent.ground` looks again first).

    Args:
        target: the target as it was before the attempt.
        camera: what the look after the attempt shows.
    """
    if camera is None:
        return None
    if camera.target_tilted and target.affordance.fragility >= BRITTLE:
        return "it has fallen over and may be broken"
    if camera.deformed:
        return "it has been bent or crushed"
    return None
