"""How long to wait before asking a server again: exponential, with jitter from a seeded generator, or as the server says."""

from __future__ import annotations

from datetime import UTC, datetime
from email.utils import parsedate_to_datetime

import numpy as np

FIRST, FACTOR, LONGEST = 0.5, 2.0, 30.0
"""First wait [s], its growth, and the longest one [s]."""
LONGEST_ASKED = 120.0
"""A server that asks for more than this [s] is taken to be out of service."""


def back_off(trial: int, rng: np.random.Generator, asked: float | None = None) -> float:
    """Seconds to wait after the failed trial number `trial` (from 0).

    Args:
        trial: Number of the trial that failed.
        rng: Draws the jitter: half to the whole of the exponential wait, so that many clients do not come back at once.
        asked: What the server asked for (Retry-After) [s]; never waited less than that.
    """
    wait = min(LONGEST, FIRST * FACTOR**trial) * float(rng.uniform(0.5, 1.0))
    return max(wait, asked) if asked is not None else wait


def retry_after(value: str | None, now: datetime | None = None) -> float | None:
    """Seconds that a Retry-After header asks for, as a number or as a date; None where it says nothing readable."""
    if value is None:
        return None
    try:
        seconds = float(value)
    except ValueError:
        try:
            at = parsedate_to_datetime(value)
        except ValueError:
            return None
        seconds = (at - (now or datetime.now(UTC))).total_seconds()
    return min(LONGEST_ASKED, seconds) if seconds >= 0 else 0.0
