"""The sentences of the benchmark's suites are sentences that the robot understands."""

from __future__ import annotations

import pytest

from agent.language.notation import noted
from agent.language.read_command import understand
from sim.scene_file import builtin_scenes, load_scene
from sim.tasks.clutter import clutter_scenes


@pytest.mark.parametrize("scene", [*builtin_scenes(), *clutter_scenes()])
def test_every_sentence_of_a_scene_is_understood(scene: str) -> None:
    """No instruction of a suite is refused, asked back, or taken to speak of something else beside its thing."""
    task = load_scene(scene).task
    for said in task.instructions if task else ():
        meant = noted(understand(said))
        assert meant not in ("ask", "refuse"), said
        assert "clutter" not in meant, said
