"""Videos: samples of the motion at a steady pace, written to a file that opens again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sim import video
from sim.recording import Recording
from sim.video import SAMPLE_S, MotionSampler, choose_moments, write_video


def recording(start: float, count: int, attempt: int = 0) -> Recording:
    """`count` steps of 2 ms from `start`; the first coordinate is the time."""
    time = start + 0.002 * np.arange(count)
    qpos = np.repeat(time[:, None], 3, axis=1)
    empty = np.zeros((count, 1))
    return Recording("lift", attempt, time, qpos, empty, empty, empty)


def test_samples_are_evenly_apart_over_phases() -> None:
    """However the motion is cut into phases, samples are `SAMPLE_S` apart."""
    sampler = MotionSampler()
    for start in np.arange(0.0, 2.0, 0.25):
        sampler.on_recording(recording(float(start), 125))
    steps = np.diff([moment.time for moment in sampler.moments])
    assert len(sampler.moments) == 14
    assert np.allclose(steps, SAMPLE_S, atol=0.0021)


def test_samples_are_copies() -> None:
    """What the physics does with its arrays later does not change a sample."""
    sampler, made = MotionSampler(), recording(0.0, 10)
    sampler.on_recording(made)
    made.qpos[:] = 99.0
    assert sampler.moments[0].qpos[0] == 0.0


def test_sampling_goes_on_when_the_world_is_put_back() -> None:
    """A clock that jumps back (a restored world) does not silence the sampler."""
    sampler = MotionSampler()
    sampler.on_recording(recording(5.0, 200))
    sampler.on_recording(recording(1.0, 200))
    assert sum(moment.time < 4.0 for moment in sampler.moments) >= 3


@pytest.mark.parametrize(("count", "most"), [(5, 10), (10, 10), (1000, 70), (2, 1)])
def test_at_most_so_many_moments_are_chosen_in_order(count: int, most: int) -> None:
    """Never more than asked for, in order, without repeats."""
    sampler = MotionSampler()
    sampler.on_recording(recording(0.0, count * 80))
    chosen = choose_moments(sampler.moments[:count], most)
    times = [moment.time for moment in chosen]
    assert len(chosen) == min(count, most)
    assert times == sorted(set(times))


def test_a_gif_has_all_frames_at_the_wanted_pace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without ffmpeg the video is a GIF whose frames and duration are those asked for."""
    monkeypatch.setattr(video.shutil, "which", lambda _name: None)
    shades = [np.full((20, 30, 3), level, np.uint8) for level in (0, 60, 120, 180, 240)]
    seen: list[int] = []
    path = write_video(iter(shades), tmp_path / "video", fps=10, progress=seen.append)
    assert path.name == "video.gif"
    assert seen == [1, 2, 3, 4, 5]
    with Image.open(path) as opened:
        assert opened.n_frames == 5
        assert opened.info["duration"] == 100
        opened.seek(4)
        assert opened.convert("RGB").getpixel((5, 5))[0] > 200


def test_an_encoder_that_fails_leaves_a_gif(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An ffmpeg that cannot encode is no reason to have no video."""
    monkeypatch.setattr(video.shutil, "which", lambda _name: "/bin/false")
    path = write_video(iter([np.zeros((8, 8, 3), np.uint8)] * 2), tmp_path / "video", fps=5)
    assert [entry.name for entry in tmp_path.iterdir()] == ["video.gif"]
    assert path.stat().st_size > 0
