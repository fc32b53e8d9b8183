"""Forces over time, and their drawing as text."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.force_trace import BLOCKS, ForceTrace, force_lines, sparkline
from sim.recording import Recording

SENSORS = {"robot/grip_force": slice(0, 1), "robot/wrist_force": slice(1, 4), "robot/opening": slice(4, 5)}


@given(st.lists(st.floats(0, 1000), min_size=1, max_size=300), st.integers(1, 120))
def test_a_sparkline_keeps_its_width_and_its_peak(values: list[float], width: int) -> None:
    """It is as wide as asked (or as there are values), and a peak is never lost."""
    line = sparkline(values, width)
    assert len(line) == min(width, len(values))
    assert set(line) <= set(BLOCKS)
    if max(values) > 1e-6:
        assert BLOCKS[-1] in line


def test_samples_keep_the_largest_force_in_between() -> None:
    """A one-step spike survives the thinning to 20 ms."""
    trace = ForceTrace()
    trace.listen_to(SENSORS)
    count = 100
    sensed = np.zeros((count, 5))
    sensed[37, 0] = -42.0
    sensed[61, 1:4] = (3.0, 4.0, 12.0)
    sensed[:, 4] = 0.05
    time = 0.002 * np.arange(count)
    empty = np.zeros((count, 1))
    trace.on_recording(Recording("close", 2, time, empty, empty, empty, sensed))
    rows = trace.rows()
    assert len(rows) == 10
    assert max(row["grip_n"] for row in rows) == pytest.approx(42.0)
    assert max(row["wrist_n"] for row in rows) == pytest.approx(13.0)
    assert {(row["motion"], row["phase"], row["opening_m"]) for row in rows} == {(2, "close", 0.05)}


def test_every_motion_gets_its_lines_with_phases_under_them() -> None:
    """Two motions are drawn apart, each with gripper, wrist and phase lines of one width."""
    rows = [
        {"t": 0.02 * i, "motion": i // 100, "phase": "lift" if i % 100 < 50 else "hold", "grip_n": 5.0, "wrist_n": 1.0}
        for i in range(200)
    ]
    lines = force_lines(rows, 80)
    assert [line.split(":")[0] for line in lines if line.startswith("motion")] == ["motion 0", "motion 1"]
    assert sum("peak 5.0 N" in line for line in lines) == 2
    assert lines[3].index("hold") - lines[3].index("lift") == 31
