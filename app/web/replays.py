"""Runs that can be looked at again with the slider: sampled joints of every turn that moved, kept with the session."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

KEPT = 20
"""Runs kept of a session, the latest."""
MAX_BYTES = 16_000_000
"""A replay file larger than this is not one of ours."""
PATTERN = "replay-*.npz"


@dataclass(frozen=True)
class Replay:
    """One turn's motion."""

    number: int
    words: str
    """What was said."""
    place: str
    """Scene and seed, without which the joints say nothing."""
    times: NDArray[np.float32]
    """Simulated time [s], (T,)."""
    poses: NDArray[np.float32]
    """Joints of robot and objects, (T, nq)."""

    def card(self) -> dict[str, Any]:
        """For the list on the page."""
        return {
            "run": self.number,
            "words": self.words[:80],
            "seconds": round(float(self.times[-1] - self.times[0]), 1),
        }

    def at(self, share: float) -> NDArray[np.float64]:
        """The joints (nq,) at a share of the run's duration in [0, 1]."""
        wanted = self.times[0] + share * (self.times[-1] - self.times[0])
        return self.poses[int(np.abs(self.times - wanted).argmin())].astype(np.float64)


@dataclass
class Replays:
    """The replays of one session."""

    folder: Path | None = None
    """Folder of the session, or None to keep them in memory only."""
    runs: dict[int, Replay] = field(default_factory=dict)

    def load(self) -> None:
        """Reads what an earlier process kept; files that are damaged are left out."""
        if self.folder is None or not self.folder.is_dir():
            return
        for path in sorted(self.folder.glob(PATTERN))[-KEPT:]:
            replay = _read(path)
            if replay is not None:
                self.runs[replay.number] = replay

    def add(self, words: str, place: str, times: list[float], poses: list[NDArray[np.float32]]) -> Replay | None:
        """Keeps a turn's motion; None if nothing moved."""
        if len(times) < 2:
            return None
        number = max(self.runs, default=-1) + 1
        replay = Replay(number, words, place, np.asarray(times, np.float32), np.stack(poses))
        self.runs[number] = replay
        for old in sorted(self.runs)[:-KEPT]:
            del self.runs[old]
            if self.folder is not None:
                self._path(old).unlink(missing_ok=True)
        if self.folder is not None:
            self._write(replay)
        return replay

    def cards(self, place: str) -> list[dict[str, Any]]:
        """The runs in that scene and seed, the latest first."""
        numbers = sorted(self.runs, reverse=True)
        return [self.runs[number].card() for number in numbers if self.runs[number].place == place]

    def _path(self, number: int) -> Path:
        assert self.folder is not None
        return self.folder / f"replay-{number:06d}.npz"

    def _write(self, replay: Replay) -> None:
        """On disk; a disk that is full costs the replay after a restart, nothing else."""
        path = self._path(replay.number)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            part = path.with_suffix(".part")
            with part.open("wb") as file:
                np.savez_compressed(
                    file,
                    words=np.array(replay.words),
                    place=np.array(replay.place),
                    times=replay.times,
                    poses=replay.poses,
                )
            part.replace(path)
        except OSError:
            return


def _read(path: Path) -> Replay | None:
    try:
        if path.stat().st_size > MAX_BYTES:
            return None
        with np.load(path, allow_pickle=False) as data:
            times, poses = data["times"], data["poses"]
            if times.ndim != 1 or poses.ndim != 2 or len(times) != len(poses) or len(times) < 2:
                return None
            return Replay(int(path.stem.removeprefix("replay-")), str(data["words"]), str(data["place"]), times, poses)
    except (OSError, ValueError, KeyError):
        return None
