"""The trials of a run, sorted into what the report's sections ask for."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from agent.configuration import CONFIGURATIONS
from bench.suite import GROUPS, MISHAP_SUITE, TWELVE
from bench.trial import CORE_SUITE, Trial, in_order

CATEGORIES: dict[str, tuple[str, ...]] = {
    "SG": GROUPS["single"],
    "IT": GROUPS["interaction"],
    "LH": GROUPS["long_horizon"],
}
"""The twelve tasks in the paper's three categories: single grasp, interactive, long horizon."""
CATEGORY_WORDS = {"SG": "Single grasp", "IT": "Interactive", "LH": "Long horizon"}

ORDER = (
    "full", "no_recovery", "no_memory", "no_scene_graph", "heuristic", "no_haarag", "vlm_only",
    "heuristic_scene_graph", "heuristic_scene_graph_memory", "blind_retry", "no_constraints", "paper_literal",
    "levels_as_written", "random_in_category", "geometry_only", "oracle_perception", "oracle_phi",
)  # fmt: skip
"""The paper's seven first, in its order, then the rivals and variants."""


EVERY = "_all"
"""Suffix of the sample of all configurations."""


@dataclass(frozen=True)
class Sample:
    """Trials that one table counts."""

    suffix: str
    """Of the table's name."""
    words: str
    """Which trials these are."""
    trials: Sequence[Trial]


class Results:
    """Trials of a run; the tables are made at one noise level, the curve over all."""

    def __init__(self, trials: Iterable[Trial]) -> None:
        self.all = in_order(trials)
        self.noises = tuple(sorted({t.noise for t in self.all}))
        self.noise = 1.0 if 1.0 in self.noises else self.noises[0]
        self.at_noise = [t for t in self.all if t.noise == self.noise]
        present = {t.configuration for t in self.all}
        self.configurations = (*(c for c in ORDER if c in present), *sorted(present.difference(ORDER)))
        tasks = {t.task for t in self.at_noise}
        self.twelve = tuple(task for task in TWELVE if any(t.task == task and is_core(t) for t in self.at_noise))
        self.others = tuple(sorted({(t.suite, t.task) for t in self.at_noise if not is_core(t)}))
        self.tasks = tuple(sorted(tasks))

    @property
    def categories(self) -> tuple[str, ...]:
        """Categories with at least one trial."""
        return tuple(name for name, tasks in CATEGORIES.items() if any(task in self.twelve for task in tasks))

    def of(self, configuration: str, tasks: Sequence[str] | None = None, noise: float | None = None) -> list[Trial]:
        """Trials of a configuration on the twelve tasks (or those named), at the tables' noise level (or the given)."""
        wanted = self.twelve if tasks is None else tasks
        level = self.noise if noise is None else noise
        own = [t for t in self.all if t.configuration == configuration and t.noise == level]
        if not self.twelve and tasks is None:
            return own
        return [t for t in own if is_core(t) and t.task in wanted]

    def samples(self, configuration: str) -> list[Sample]:
        """A configuration's trials; where they fail seldom, also those of every noise, with mishaps, and of all configurations."""
        found = [Sample("", configuration, self.of(configuration))]
        if len(self.noises) > 1:
            noisy = [trial for level in self.noises for trial in self.of(configuration, noise=level)]
            found.append(Sample("_noises", f"{configuration}, noise {self.noises[0]:g} to {self.noises[-1]:g}", noisy))
        if unlucky := self.of_suite(configuration, MISHAP_SUITE):
            found.append(Sample("_mishaps", f"{configuration}, mishaps", unlucky))
        own = [name for name in self.configurations if not _is_told(name)]
        if len(own) > 1:
            every = [trial for name in own for trial in self.of(name)]
            found.append(Sample(EVERY, "all configurations together; they share many attempts", every))
        return found

    def telling(self, tells: Callable[[Sequence[Trial]], bool]) -> list[Sample]:
        """The samples that tell something, of the first configuration whose own trials do; none if nothing does."""
        for configuration in self.configurations:
            found = [sample for sample in self.samples(configuration) if tells(sample.trials)]
            if any(sample.suffix != EVERY for sample in found):
                return found
        return []

    def of_suite(self, configuration: str, suite: str, task: str | None = None) -> list[Trial]:
        """Trials of a configuration outside the twelve tasks."""
        return [
            t
            for t in self.at_noise
            if t.configuration == configuration
            and t.suite == suite
            and not is_core(t)
            and (task is None or t.task == task)
        ]


def _is_told(name: str) -> bool:
    """The evaluator tells this configuration what failed: its diagnosis is not the robot's."""
    known = CONFIGURATIONS.get(name)
    return known is not None and known.switches.diagnosis == "oracle_phi"


def is_core(trial: Trial) -> bool:
    """The trial belongs to the twelve tasks: those of other suites never enter their mean."""
    return trial.task in TWELVE and trial.suite == CORE_SUITE


def category_of(task: str) -> str | None:
    """The category of one of the twelve tasks."""
    return next((name for name, tasks in CATEGORIES.items() if task in tasks), None)


def solved(trials: Sequence[Trial]) -> tuple[int, int]:
    """Successes and trials."""
    return sum(t.success for t in trials), len(trials)
