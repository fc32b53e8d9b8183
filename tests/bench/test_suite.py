"""The suites: names, seeds, sentences, and the clutter's worlds."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from app.command_line import run_command_line
from bench.suite import GROUPS, TWELVE, instruction_of, seed_of, tasks_of
from kb.errors import BadInputError
from sim.draw_scene import draw_scene
from sim.footprint import gap, outline
from sim.scene_file import builtin_scenes, load_scene
from sim.tasks.clutter import GAP, TARGETS


def test_every_builtin_scene_is_a_task() -> None:
    """The suite has twelve tasks and four supplementary ones, which are the built-in scenes, no more and no less."""
    assert len(TWELVE) == len(set(TWELVE)) == 12
    assert {name for group in GROUPS.values() for name in group} == set(builtin_scenes())
    assert tuple(task.name for task in tasks_of("tasks")) == TWELVE
    assert {task.suite for task in tasks_of("tasks", ["supplementary"])} == {"supplementary"}


def test_names_are_groups_or_tasks_once() -> None:
    """Groups and tasks mix; what is named twice counts once."""
    names = [task.name for task in tasks_of("tasks", ["cup_near_vase", "interaction", "single_cup"])]
    assert names == ["cup_near_vase", *(n for n in GROUPS["interaction"] if n != "cup_near_vase"), "single_cup"]


def test_every_task_has_five_wordings_and_the_seed_picks_one() -> None:
    """At least five sentences a task, all of them reached by the seeds of a repetition, the same one for each seed."""
    for name in (*builtin_scenes(), "clutter_apple"):
        task = load_scene(name).task
        assert task is not None
        assert len(task.instructions) >= 5
        said = [instruction_of(name, seed_of(20_000, 0, trial)) for trial in range(30)]
        assert set(said) == set(task.instructions)
        assert instruction_of(name, 20_007) == said[7]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--tasks", "single_cub"], ("--tasks", "single_cub", "single_cup", "long_horizon")),
        (["--configs", "fulll"], ("fulll", "full", "blind_retry")),
        (["--suite", "mess"], ("--suite", "mess", "clutter")),
        (["--suite", "clutter", "--tasks", "single_cup"], ("single_cup", "clutter_cup")),
        (["--trials", "0"], ("--trials", "1 to 1000")),
        (["--noise", "3.5"], ("--noise", "0 to 3")),
        (["--noise", "loud"], ("--noise", "loud")),
        (["--noise", "nan"], ("--noise", "0 to 3")),
        (["--workers", "0"], ("--workers", "1 to")),
        (["--repetitions", "-1"], ("--repetitions", "1 to")),
        (["--evaluator", "judge"], ("--evaluator", "mujoco")),
        (["--tasks", ","], ("--tasks", "empty")),
    ],
)
def test_bad_input_is_one_line_with_the_choices(
    arguments: list[str], words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whatever is wrong with the options: exit code 2, one line that says what, where and the choices; nothing written."""
    assert run_command_line(["bench", *arguments, "--out", f"{tmp_path}/out"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    for word in words:
        assert word in said
    assert not list(tmp_path.iterdir())


def test_unknown_tasks_are_refused() -> None:
    """The message lists the valid names."""
    with pytest.raises(BadInputError, match="sort_by_fragility"):
        tasks_of("tasks", ["sort"])


def test_clutter_is_tight_and_free() -> None:
    """All twelve objects stand on the table, none nearer than 5 mm to another, and most within a finger's room of one."""
    placed = draw_scene(load_scene("clutter_cup"), 20_003)
    edges = {thing.id: outline(thing) for thing in placed.objects}
    assert set(edges) == set(TARGETS)
    gaps = {frozenset(pair): gap(edges[pair[0]], edges[pair[1]]) for pair in itertools.combinations(edges, 2)}
    assert min(gaps.values()) >= GAP - 1e-6
    nearest = [min(free for pair, free in gaps.items() if name in pair) for name in edges]
    assert sorted(nearest)[6] < 0.03


def test_clutter_is_the_same_for_every_target() -> None:
    """The world follows from the seed; only the task's target differs."""
    one, two = (draw_scene(load_scene(f"clutter_{target}"), 20_001) for target in ("cup", "phone"))
    assert [(a.position, a.quaternion, a.mass, a.geoms[0].rgba) for a in one.objects] == [
        (b.position, b.quaternion, b.mass, b.geoms[0].rgba) for b in two.objects
    ]
    assert one.task is not None
    assert two.task is not None
    assert (one.task.target, two.task.target) == ("cup", "phone")
    other = draw_scene(load_scene("clutter_cup"), 20_002)
    assert one.objects[0].position != other.objects[0].position


def test_noise_scales_what_cannot_be_known() -> None:
    """Noise leaves places, sizes and true camera poses alone, and scales mass, friction and calibration errors."""
    spec = load_scene("cup_near_vase")
    calm, plain, loud = (draw_scene(spec, 20_000, noise=noise) for noise in (0.0, 1.0, 3.0))
    for a, b, c in zip(calm.objects, plain.objects, loud.objects, strict=True):
        assert a.position == b.position == c.position
        assert a.size == b.size == c.size
        assert c.mass - a.mass == pytest.approx(3 * (b.mass - a.mass))
        assert c.friction - a.friction == pytest.approx(3 * (b.friction - a.friction))
    for a, b, c in zip(calm.cameras, plain.cameras, loud.cameras, strict=True):
        assert (a.true_pose == b.true_pose).all()
        assert (a.told_pose == a.true_pose).all()
        off, far = ((x.told_pose - x.true_pose)[:3, 3] for x in (b, c))
        assert far == pytest.approx(3 * off)
