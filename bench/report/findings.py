"""What the run shows, in plain words, and the figures at the top of the page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench.paper_tables import MEAN_ATTEMPTS, RECOVERED, TABLE_II, TABLE_V, TRIALS
from bench.report.contrasts import REGISTERED, Contrast, adjusted, contrasts
from bench.report.recovery import subgoals
from bench.report.results import CATEGORIES, CATEGORY_WORDS, Results, solved
from bench.report.safety import satisfaction
from bench.report.value import DASH, Count, PValue, signed
from bench.statistics import wilson

ALPHA = 0.05
"""Level at which a registered contrast counts as shown."""
MOST = 6
"""So many tasks are named in a sentence; the tables hold them all."""


@dataclass(frozen=True)
class Finding:
    """One sentence and how it is to be taken."""

    mark: str
    """shown, not shown, worse, harness."""
    words: str


@dataclass(frozen=True)
class Card:
    """One figure at the top."""

    title: str
    value: str
    detail: str
    paper: str


def cards(results: Results, configuration: str = "full") -> list[Card]:
    """The headline figures of a configuration beside the paper's."""
    trials = results.of(configuration)
    if not trials:
        return []
    printed = TABLE_II[0]
    found = [_share("All tasks", Count(*solved(trials)), f"{100 * printed.total / 360:.1f} %")]
    for name in results.categories:
        theirs = f"{100 * printed.counts[name] / TRIALS[name]:.1f} %"
        found.append(_share(CATEGORY_WORDS[name], Count(*solved(results.of(configuration, CATEGORIES[name]))), theirs))
    goals = [goal for goal in subgoals(trials) if goal.attempts]
    recovered = Count(sum(goal.recovered for goal in goals), sum(goal.first_failed for goal in goals))
    per_success = sum(len(g.attempts) for g in goals) / max(1, sum(g.success for g in goals))
    events = sum(t.damage_events for t in trials)
    theirs = f"{100 * RECOVERED[0] / RECOVERED[1]:.1f} % of trials"
    return [
        *found,
        _share("Constraints kept", satisfaction(trials), f"{100 * TABLE_V[-1].satisfied:.0f} %"),
        _share("Recovered sub-goals", recovered, theirs),
        Card(
            "Damage per 100 trials",
            f"{100 * events / len(trials):.1f}",
            f"{events} event{'' if events == 1 else 's'}, {len(trials)} trials",
            "not reported",
        ),
        Card("Attempts per success", f"{per_success:.2f}", f"{len(goals)} sub-goals", f"{MEAN_ATTEMPTS} per trial"),
    ]


def _share(title: str, count: Count, paper: str) -> Card:
    if count.share is None:
        return Card(title, DASH, "nothing counted", paper)
    interval = wilson(count.k, count.n)
    detail = f"{count.k} of {count.n}, 95 % {100 * interval.low:.1f}–{100 * interval.high:.1f}"
    return Card(title, f"{100 * count.share:.1f} %", detail, paper)


def findings(results: Results) -> list[Finding]:
    """What was shown and what was not, one sentence per registered contrast, then what else is no worse than full."""
    found = contrasts(results)
    holm_p = adjusted(found)
    words = [_contrast(item, holm_p[item.name]) for item in found if item.name in holm_p]
    errors = sum(t.harness_error is not None for t in results.all)
    said = f"{errors or 'None'} of the {len(results.all)} trials ended in a harness error"
    return [*words, *_peers(found), Finding("harness", f"{said}; they count as failures." if errors else f"{said}.")]


def _peers(found: Sequence[Contrast]) -> list[Finding]:
    """Configurations outside the registered family that full is not ahead of: nobody should have to look for them."""
    own = [item for item in found if item.name not in REGISTERED and item.name == item.rival and item.lead <= 0]
    if not own:
        return []
    named = [
        f"{item.rival} ({item.solved[0]} against {item.solved[1]} of {item.count})"
        for item in sorted(own, key=lambda item: (item.lead / item.count, item.rival))
    ]
    return [Finding("not shown", f"Not registered, and full is not ahead of them either: {_enumerated(named)}.")]


def silent(results: Results) -> list[str]:
    """What was to be compared and could not be, one sentence each."""
    made = {item.name for item in contrasts(results)}
    words: list[str] = []
    for name in REGISTERED:
        if name in made:
            continue
        rival, _, level = name.partition(" at noise ")
        noise = float(level) if level else results.noise
        ran = any(t.configuration == rival and t.noise == noise for t in results.all)
        why = "no first attempt of full failed in a trial of both" if ran and level else "the two share no trial"
        words.append(f"full against {name}: nothing to compare, {why}.")
    return words


def _contrast(item: Contrast, p: float) -> Finding:
    numbers = f"{signed(item.difference.value)} pp on {item.count} paired trials, p = {PValue(p)} after Holm"
    numbers = numbers.replace("p = <", "p <")
    rival = item.rival
    where = " after a failed first attempt" + item.name.removeprefix(rival).replace(" at", " at", 1)
    place = where if item.name != rival else ""
    if p < ALPHA and item.difference.value > 0:
        behind = _tasks(item, "behind on", worse=True)
        return Finding(
            "shown", f"full beats {rival}{place}: {numbers}{_tasks(item, 'ahead on')}{behind}.{_narrow(item)}"
        )
    if p < ALPHA:
        return Finding("worse", f"full is worse than {rival}{place}: {numbers}{_tasks(item, 'behind on', worse=True)}.")
    behind = _tasks(item, "behind on", worse=True)
    words = f"This run does not show that full beats {rival}{place}: {numbers}{_tasks(item, 'ahead on')}{behind}."
    return Finding("not shown", words)


def _narrow(item: Contrast) -> str:
    """What a sceptic would ask of a lead: whether one task alone makes it, and whether other tasks would have shown it."""
    leads = {task: sum(a - b for a, b in outcomes) for task, outcomes in item.pairs.items()}
    best = max(leads, key=lambda task: leads[task])
    words = ""
    if len(leads) > 1 and item.lead - leads[best] <= 0:
        rest = [pair for task, outcomes in item.pairs.items() if task != best for pair in outcomes]
        words += f" Without {best} it is {sum(a for a, _ in rest)} against {sum(b for _, b in rest)} of {len(rest)}."
    if len(leads) > 1 and item.over_tasks.low <= 0.0 < item.over_tasks.high:
        words += " With the tasks drawn anew as well, the interval includes zero."
    return words


def _tasks(item: Contrast, what: str, *, worse: bool = False) -> str:
    """The tasks on which full is ahead (or behind), with their counts, the clearest first."""
    found: list[tuple[float, str]] = []
    for task, outcomes in item.pairs.items():
        mine, theirs = sum(a for a, _ in outcomes), sum(b for _, b in outcomes)
        lead = (theirs - mine if worse else mine - theirs) / len(outcomes)
        if lead > 0:
            found.append((-lead, f"{task} ({mine} against {theirs} of {len(outcomes)})"))
    words = [text for _, text in sorted(found)]
    if len(words) > MOST:
        words = [*words[: MOST - 1], f"{len(words) - MOST + 1} more tasks"]
    return f"; {what} {_enumerated(words)}" if words else ""


def _enumerated(words: Sequence[str]) -> str:
    return ", ".join(words[:-1]) + f" and {words[-1]}" if len(words) > 1 else words[0]
