"""The wrist's readings in plain numbers are those in arrays."""

from __future__ import annotations

import numpy as np
import pytest

from sim.wrench import WristReader

NAMES = ("wrist_force", "wrist_torque", "hand_acceleration", "tcp_acceleration", "tcp_quaternion")


def test_plain_numbers_are_the_arrays_own() -> None:
    """The force of one row is the same bit for bit, the mass to rounding; in free fall the mass is not a number."""
    reader = WristReader({f"robot/{name}": slice(4 * i, 4 * i + 3) for i, name in enumerate(NAMES)})
    rng = np.random.default_rng(1)
    for row in rng.normal(0.0, 10.0, (200, 20)):
        assert reader.force_now(row) == tuple(reader.force(row).tolist())
        assert reader.mass_now(row) == pytest.approx(float(reader.mass(row[None])[0]), rel=1e-12)
    assert np.isnan(reader.mass_now(np.zeros(20)))
