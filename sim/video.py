"""Videos of a run for people: samples of the motion while it happens, painted afterwards.

MP4 where an encoder is in reach (the program `ffmpeg`), an animated GIF otherwise. Needs nothing beyond pillow.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kb.sensing import Phase
from sim.picture import DRAFT, PictureMaker
from sim.recording import Recording
from sim.viewpoint import TABLE_SIDE, Viewpoint

SAMPLE_S = 0.15
"""Simulated time between two samples [s]."""
SPEED = 2.0
"""The video runs this much faster than the simulated time."""
MAX_FRAMES = {"opengl": 100, "raycast": 48}
"""Painting takes about 90 and 140 ms a frame on one core; longer runs are sampled more coarsely."""
SIZES = {"opengl": (640, 360), "raycast": (320, 180)}
"""Width and height of a frame [px], by how it is painted."""

COLOURS, PALETTE_FRAMES = 128, 6
"""Colours of a GIF, and the number of frames that they are chosen from."""


@dataclass(frozen=True)
class Moment:
    """One sample of the motion."""

    time: float
    """Simulated time [s]."""
    motion: int
    """Number of the motion."""
    phase: Phase
    qpos: NDArray[np.float64]


class MotionSampler:
    """Attached to `World.recorders`, keeps a sample of the joint positions every `SAMPLE_S`."""

    def __init__(self) -> None:
        self.moments: list[Moment] = []
        self._next = -np.inf

    def on_recording(self, recording: Recording) -> None:
        """Takes the samples that are due in this phase."""
        for row, time in enumerate(recording.time):
            # A world that was put back to an earlier moment starts the clock again.
            if time >= self._next or time < self._next - 2 * SAMPLE_S:
                self.moments.append(Moment(float(time), recording.attempt, recording.phase, recording.qpos[row].copy()))
                self._next = float(time) + SAMPLE_S


def choose_moments(moments: Sequence[Moment], most: int) -> list[Moment]:
    """At most `most` moments, evenly spread, the last one included."""
    if len(moments) <= most:
        return list(moments)
    return [moments[i] for i in np.linspace(0, len(moments) - 1, most).round().astype(int)]


def paint_moments(
    maker: PictureMaker, moments: Sequence[Moment], viewpoint: Viewpoint = TABLE_SIDE
) -> Iterator[NDArray[np.uint8]]:
    """One frame a moment, (H, W, 3), as fast as the machine's way of painting allows."""
    width, height = SIZES[maker.kind]
    for moment in moments:
        yield maker.picture(moment.qpos, viewpoint, width, height, DRAFT)


def write_video(
    frames: Iterator[NDArray[np.uint8]],
    stem: Path,
    *,
    fps: float,
    progress: Callable[[int], None] = lambda _count: None,
) -> Path:
    """Writes `stem.mp4` if `ffmpeg` is on the path, else `stem.gif`, and returns the file's path.

    Args:
        frames: Pictures (H, W, 3) of one size.
        stem: Path without suffix.
        fps: Frames a second.
        progress: Told the number of frames painted so far.
    """
    counted = _count(frames, progress)
    encoder = shutil.which("ffmpeg")
    if encoder is not None:
        target = stem.with_suffix(".mp4")
        if _encode(encoder, pictures := list(counted), target, fps):
            return target
        counted = iter(pictures)
    return _write_gif(counted, stem.with_suffix(".gif"), fps)


def _count(frames: Iterator[NDArray[np.uint8]], progress: Callable[[int], None]) -> Iterator[NDArray[np.uint8]]:
    for number, frame in enumerate(frames, start=1):
        progress(number)
        yield frame


def _encode(encoder: str, pictures: Sequence[NDArray[np.uint8]], target: Path, fps: float) -> bool:
    """Pipes raw pictures through ffmpeg; False if this build of it cannot."""
    height, width = pictures[0].shape[:2]
    command = [
        encoder, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}",
        "-r", f"{fps:g}", "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", str(target),
    ]  # fmt: skip
    data = b"".join(np.ascontiguousarray(picture).tobytes() for picture in pictures)
    done = subprocess.run(command, input=data, capture_output=True, check=False)
    if done.returncode != 0:
        target.unlink(missing_ok=True)
    return done.returncode == 0


def _write_gif(frames: Iterator[NDArray[np.uint8]], target: Path, fps: float) -> Path:
    """An animated GIF with one palette for all frames, so that nothing flickers."""
    from PIL import Image

    first, *rest = [Image.fromarray(frame) for frame in frames]
    # Colours that appear later (an object turned, the bin in view) must be in the palette too.
    shown = [(first, *rest)[i] for i in np.unique(np.linspace(0, len(rest), PALETTE_FRAMES).round().astype(int))]
    sheet = Image.new("RGB", (first.width, first.height * len(shown)))
    for row, picture in enumerate(shown):
        sheet.paste(picture, (0, row * first.height))
    palette = sheet.quantize(colors=COLOURS, method=Image.Quantize.MEDIANCUT)
    indexed = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in (first, *rest)]
    indexed[0].save(
        target, save_all=True, append_images=indexed[1:], duration=round(1000 / fps), loop=0, optimize=False
    )
    return target
