"""The retry ladder: budget, level of the attempt being prepared, and when trying again would be dishonest (Sec. IV-B)."""

from __future__ import annotations

from kb.percept import PerceivedObject
from kb.run_result import Level
from kb.sensing import CameraEvidence, Sensing
from kb.switches import Switches
from tools.diagnosis.claim import LEAST_LOAD

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
CARRIED = 0.3
"""Share of the load after the test lift below which it is gone."""
FRAGILE, FELL_S = 0.3, 1.0
"""Things at least so fragile may be broken after a fall of 5 cm (benchmark section 3). The lift takes 1.3 s: what was lost
after one of them [s] had been raised by 6 cm at least, what was lost within 0.8 s by at most 2.5 (19 tuning trials)."""


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


def irreversible(target: PerceivedObject, camera: CameraEvidence | None, sensing: Sensing | None = None) -> str | None:
    """Why another attempt would make no sense, or None: the damage that the robot can see or must expect (ledger G46).

    Things that are merely not seen are no proof: the next look may show them (`agent.ground` looks again first).

    Args:
        target: the target as it was before the attempt.
        camera: what the look after the attempt shows.
        sensing: what the hand felt during the attempt.
    """
    if sensing is not None and target.affordance.fragility >= FRAGILE and fell(sensing):
        return "it fell out of my hand and may be broken"
    if camera is None:
        return None
    if camera.target_tilted and target.affordance.fragility >= BRITTLE:
        return "it has fallen over and may be broken"
    if camera.deformed:
        return "it has been bent or crushed"
    return None


def fell(sensing: Sensing) -> bool:
    """Whether something was lost from a height of 5 cm or more: it was carried for `FELL_S`, and then it was not."""
    lost = sensing.load_end < max(LEAST_LOAD, CARRIED * sensing.load_lifted)
    return lost and sensing.held_s >= FELL_S
