"""Tracks: what all sensors give at once is what each of them gives alone."""

from __future__ import annotations

import numpy as np

from sim.recording import Recording
from sim.track import ROW_STEPS, compact, layout_of, sliding_mean
from tools.open_world import open_world


def test_forces_of_all_contacts_at_once_are_those_of_each() -> None:
    """Every column of a track is the peak in its row of the sliding mean of its own sensor, bit for bit."""
    opened = open_world("cup_near_vase", 11_000)
    world, recordings = opened.world, list[Recording]()

    class Kept:
        def on_recording(self, recording: Recording) -> None:
            recordings.append(recording)

    world.recorders.append(Kept())
    thing = opened.placed.objects[0].id
    speed = world.index.objects[thing].qvel
    assert speed is not None
    world.data.qvel[speed] = [0.2, 0.1, 1.0, 0.0, 1.0, 0.0]
    world.run(np.repeat(world.data.ctrl[None], 207, axis=0), "shake")
    layout, index, recording = layout_of(opened.placed, world.index), world.index, recordings[0]
    track = compact(recording, layout, index, opened.placed)
    starts = np.arange(0, len(recording), ROW_STEPS)

    def peak(sensor: str, *, normal: bool) -> np.ndarray:
        force = recording.sensordata[:, index.sensors[sensor]][:, 1:4]
        size = np.abs(force[:, 0]) if normal else np.linalg.norm(force, axis=1)
        return np.maximum.reduceat(sliding_mean(size[:, None]), starts, axis=0)[:, 0].astype(np.float32)

    assert float(track.table.max()) > 1.0
    for column, name in enumerate(layout.objects):
        assert np.array_equal(track.table[:, column], peak(f"truth/{name}/table", normal=False))
        assert np.array_equal(track.robot[:, column], peak(f"truth/{name}/robot", normal=True))
        for side, pad in enumerate(("pad_left", "pad_right")):
            assert np.array_equal(track.pads[:, column, side], peak(f"truth/{name}/{pad}", normal=False))
    for column, (a, b) in enumerate(layout.pairs):
        assert np.array_equal(track.pair[:, column], peak(f"truth/{a}/{b}", normal=False))
    assert np.array_equal(track.robot_table, peak("truth/table/robot", normal=True))
