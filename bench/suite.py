"""The tasks that the benchmark runs, by suite: which scene each one shows, and which sentence a trial is asked with.

A task's world, instructions and required constraints are data in `sim/scenes` and `sim/tasks`; here are only the names.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, get_args

from bench.mishaps import MISHAPS, MishapName
from kb.base import Noun
from kb.errors import BadInputError

SuiteName = Literal["tasks", "clutter", "ood", "mishaps"]
SUITES: tuple[SuiteName, ...] = get_args(SuiteName)

GROUPS: dict[str, tuple[str, ...]] = {
    "single": ("single_cup", "single_apple", "single_bottle", "single_banana", "single_bowl", "single_cube"),
    "interaction": ("cup_near_vase", "ball_behind_box", "phone_near_wine_glass", "screwdriver_side_grasp"),
    "long_horizon": ("clear_table", "sort_by_fragility"),
    "supplementary": ("filled_cup", "block_on_bowl", "repeated_categories", "phone_between_glasses"),
}
"""Tasks of the suite `tasks` by kind (benchmark section 3): SG, IT, LH, and S1 to S4 that never enter the mean."""
TWELVE = (*GROUPS["single"], *GROUPS["interaction"], *GROUPS["long_horizon"])
"""The tasks of the headline number."""
MISHAP_SUITE: SuiteName = "mishaps"
BETWEEN = "."
"""Stands between a mishap and the task that it happens in."""
CLUTTER_SCENES = 10
"""Scenes of the clutter suite; each of its objects is the target once in each."""


class BenchTask(Noun):
    """One task of a suite. Its scene has its name, behind that of a mishap."""

    name: str
    suite: str
    """Suite as it stands in a row: "tasks", "supplementary", "clutter", "mishaps", "ood_in_dist", "ood_near" or "ood_far"."""
    mishap: MishapName | None = None
    """What goes wrong around the first grasp."""

    @property
    def scene(self) -> str:
        """Name of its scene."""
        return self.name if self.mishap is None else self.name.removeprefix(f"{self.mishap}{BETWEEN}")


def tasks_of(suite: str, names: Iterable[str] | None = None) -> tuple[BenchTask, ...]:
    """The tasks named, or the suite's default ones: the twelve, all targets of the clutter, or all single objects.

    Args:
        suite: "tasks", "clutter", "ood" (one object alone: known, or near or far out of distribution), or "mishaps" (the
            twelve again, each with every mishap around its first grasp).
        names: task names and names of groups, in any order; doubles are dropped.

    Raises:
        BadInputError: unknown suite, task or group; the message lists the valid ones.
    """
    if suite not in SUITES:
        raise BadInputError(f'unknown suite "{suite}"', where="--suite", choices=SUITES)
    known, groups = _known(suite), _groups(suite)
    default = TWELVE if suite == "tasks" else tuple(known)
    wanted: list[str] = []
    for name in default if names is None else names:
        if name in groups:
            wanted += groups[name]
        elif name in known:
            wanted.append(name)
        else:
            raise BadInputError(f'unknown task "{name}"', where="--tasks", choices=(*known, *groups))
    if not wanted:
        raise BadInputError("it names no task", where="--tasks", choices=tuple(known))
    return tuple(known[name] for name in dict.fromkeys(wanted))


def _groups(suite: str) -> dict[str, tuple[str, ...]]:
    """Groups of task names by which `--tasks` may name them."""
    if suite == "ood":
        from sim.tasks.ood import ood_groups

        return ood_groups()
    if suite == MISHAP_SUITE:
        return {mishap: tuple(f"{mishap}{BETWEEN}{task}" for task in TWELVE) for mishap in MISHAPS}
    return GROUPS if suite == "tasks" else {}


def _known(suite: str) -> dict[str, BenchTask]:
    """All tasks of a suite by name."""
    if suite == "clutter":
        from sim.tasks.clutter import clutter_scenes

        return {name: BenchTask(name=name, suite="clutter") for name in clutter_scenes()}
    if suite == "ood":
        groups = _groups(suite).items()
        return {name: BenchTask(name=name, suite=f"ood_{group}") for group, names in groups for name in names}
    if suite == MISHAP_SUITE:
        return {
            name: BenchTask(name=name, suite=MISHAP_SUITE, mishap=mishap)
            for mishap in MISHAPS
            for name in _groups(suite)[mishap]
        }
    return {
        name: BenchTask(name=name, suite="supplementary" if group == "supplementary" else "tasks")
        for group, names in GROUPS.items()
        for name in names
    }


def seed_of(base: int, repetition: int, trial: int) -> int:
    """Seed of a trial's world (benchmark section 2): the same for every configuration."""
    return base + 1000 * repetition + trial


def instruction_of(scene: str, seed: int) -> str:
    """One of the task's own sentences, by turns of the seed.

    Raises:
        BadInputError: unknown scene, or one without a task.
    """
    from sim.scene_file import load_scene

    task = load_scene(scene).task
    if task is None:
        raise BadInputError("the scene has no task", where=scene)
    return task.instructions[seed % len(task.instructions)]
