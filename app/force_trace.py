"""How the forces of a run went over simulated time, from the robot's own sensors, and how to draw them as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sim.recording import Recording

SAMPLE_S = 0.02
"""Simulated time between two samples [s]; each is the largest value within it."""
BLOCKS = " ▁▂▃▄▅▆▇█"
"""Eighths of a character's height."""


class ForceTrace:
    """Attached to `World.recorders`, keeps gripper force, wrist force and opening."""

    def __init__(self) -> None:
        self._sensors: Mapping[str, slice] = {}
        self._rows: list[dict[str, Any]] = []

    def listen_to(self, sensors: Mapping[str, slice]) -> None:
        """Which columns of the sensor data hold which sensor."""
        self._sensors = sensors

    def on_recording(self, recording: Recording) -> None:
        """Adds the samples of one phase."""
        if not len(recording):
            return
        grip = np.abs(recording.sensordata[:, self._sensors["robot/grip_force"]][:, 0])
        wrist = np.linalg.norm(recording.sensordata[:, self._sensors["robot/wrist_force"]], axis=1)
        opening = recording.sensordata[:, self._sensors["robot/opening"]][:, 0]
        bins = ((recording.time - recording.time[0]) / SAMPLE_S).astype(int)
        for number in np.unique(bins):
            inside = bins == number
            self._rows.append(
                {
                    "t": round(float(recording.time[inside][0]), 3),
                    "motion": recording.attempt,
                    "phase": recording.phase,
                    "grip_n": round(float(grip[inside].max()), 3),
                    "wrist_n": round(float(wrist[inside].max()), 3),
                    "opening_m": round(float(opening[inside][-1]), 5),
                }
            )

    def rows(self) -> list[dict[str, Any]]:
        """Samples in order: time [s], motion, phase, gripper force [N], wrist force [N], opening [m]."""
        return self._rows


def sparkline(values: Sequence[float], width: int, top: float | None = None) -> str:
    """Values as one line of block characters, each the largest value of its share of the time.

    Args:
        values: Not negative.
        width: Number of characters.
        top: Value of a full block; the largest value if None.
    """
    if not values:
        return ""
    parts = np.array_split(np.asarray(values, float), min(width, len(values)))
    peaks = np.array([part.max() for part in parts])
    full = max(top if top is not None else float(peaks.max()), 1e-9)
    levels = np.clip(np.round(peaks / full * (len(BLOCKS) - 1)), 0, len(BLOCKS) - 1).astype(int)
    return "".join(BLOCKS[level] for level in levels)


def force_lines(rows: Sequence[Mapping[str, Any]], width: int) -> list[str]:
    """Two lines of blocks a motion, gripper and wrist, with the phases under them."""
    lines: list[str] = []
    for motion in sorted({row["motion"] for row in rows}):
        own = [row for row in rows if row["motion"] == motion]
        columns = min(width - 18, len(own))
        if columns < 8:
            continue
        span = own[-1]["t"] - own[0]["t"]
        lines.append(f"motion {motion}: {span:.1f} s")
        for key, label in (("grip_n", "gripper"), ("wrist_n", "wrist")):
            values = [row[key] for row in own]
            lines.append(f"  {label:<8}{sparkline(values, columns)} peak {max(values):.1f} N")
        lines.append("  phase   " + _phase_line([row["phase"] for row in own], columns))
    return lines


def _phase_line(phases: Sequence[str], width: int) -> str:
    """Names of the phases where they begin, cut where they would run into the next."""
    canvas = [" "] * width
    starts = [i for i, phase in enumerate(phases) if i == 0 or phase != phases[i - 1]]
    for number, start in enumerate(starts):
        end = starts[number + 1] if number + 1 < len(starts) else len(phases)
        left, right = start * width // len(phases), end * width // len(phases)
        for offset, letter in enumerate(phases[start][: max(0, right - left - 1)]):
            canvas[left + offset] = letter
    return "".join(canvas)
