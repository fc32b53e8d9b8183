"""The state of a learning knowledge base: what its journal makes of the one it began with.

Lessons about a strategy that came from an entry count for that entry; all others are kept in quarantine under their key,
failures too, and no retrieval sees them. Only a promotion makes an entry of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kb.errors import BadInputError
from kb.experience import Experience
from kb.journal import BASE, JOURNAL, Change, Journal, begin
from kb.lesson import Lesson
from kb.store import ExperienceStore
from kb.store_file import StoreHeader, text_of_store

LEARNT = "learnt-"
"""Beginning of the ids of learnt entries: they turn into failures where they succeed in less than half of the trials."""


@dataclass(frozen=True)
class State:
    """Everything after some version."""

    entries: Mapping[str, Experience]
    """Those of the base and those promoted or added, by id, with all their trials."""
    quarantine: Mapping[str, tuple[Lesson, ...]] = field(default_factory=dict[str, tuple[Lesson, ...]])
    """Lessons that no entry speaks for yet, by key."""
    refused: Mapping[str, int] = field(default_factory=dict[str, int])
    """How many lessons a key had when it was refused: it is looked at again when there are more."""


class LearnedBase:
    """A folder's knowledge base, at its newest version."""

    def __init__(self, journal: Journal) -> None:
        self.journal = journal
        base = ExperienceStore.open(journal.folder / BASE)
        self._header = base.header
        self._states: list[State] = []
        self._first = State({entry.id: entry for entry in base.all()})
        self._fold()

    @classmethod
    def open(cls, folder: Path) -> LearnedBase:
        """An existing learning knowledge base.

        Raises:
            EnvironmentFaultError: its journal is damaged.
            BadInputError: there is none, or its base is damaged.
        """
        return cls(Journal(folder))

    @classmethod
    def begin(cls, folder: Path, *, empty: bool = False, start: ExperienceStore | None = None) -> LearnedBase:
        """The knowledge base of a folder, begun with the shipped one, another, or nothing if there is none yet."""
        shipped = start or ExperienceStore.open()
        entries = () if empty else shipped.all()
        says = "began empty" if empty else f"began with {len(entries)} experiences"
        return cls(begin(folder, text_of_store(shipped.header, entries), says))

    @property
    def header(self) -> StoreHeader:
        return self._header

    @property
    def state(self) -> State:
        """The newest state."""
        self._fold()
        return self._states[-1]

    @property
    def version(self) -> int:
        """Number of the newest change."""
        return len(self.journal.changes) - 1

    def at(self, version: int) -> State:
        """The state after a version.

        Raises:
            BadInputError: there is no such version.
        """
        self._fold()
        if not 0 <= version < len(self._states):
            choices = (f"0 to {len(self._states) - 1}",)
            raise BadInputError(f"there is no version {version}", where="VERSION", choices=choices)
        return self._states[version]

    def store(self) -> ExperienceStore:
        """The entries as a knowledge base for retrieval."""
        return ExperienceStore(self._header, list(self.state.entries.values()), self.journal.folder / BASE)

    def rollback(self, version: int) -> Change:
        """Goes back to a version, as a new change: nothing is forgotten, and a rollback can be rolled back.

        Raises:
            BadInputError: there is no such version.
            EnvironmentFaultError: the folder cannot be written.
        """
        with self.journal.writing():
            self.at(version)
            says = f"went back to version {version}"
            return self.journal.append(Change(version=0, kind="rolled_back", says=says, to=version))

    def _fold(self) -> None:
        for change in self.journal.changes[len(self._states) :]:
            if change.kind == "rolled_back":
                self._states.append(self._states[change.to or 0])
            else:
                self._states.append(after(self._states[-1] if self._states else self._first, change))


def after(state: State, change: Change) -> State:
    """The state after one more change (any but a rollback)."""
    if change.kind == "lesson" and change.lesson is not None:
        return _taught(state, change.lesson)
    if change.kind in ("promoted", "added") and change.entry is not None:
        entries = {**state.entries, change.entry.id: change.entry}
        left = {key: lessons for key, lessons in state.quarantine.items() if key != change.key}
        return State(entries, left, state.refused)
    if change.kind == "refused":
        count = len(state.quarantine.get(change.key, ()))
        return State(state.entries, state.quarantine, {**state.refused, change.key: count})
    return state


def speaks_for(entries: Mapping[str, Experience], lesson: Lesson) -> str | None:
    """Id of the entry that a lesson counts for: the one it used if it held the same way, or the one learnt of its key."""
    for name in (lesson.used, lesson.key):
        entry = entries.get(name) if name is not None else None
        if entry is None:
            continue
        mine, other = lesson.strategy, entry.strategy
        if (mine.region, mine.type, mine.approach) == (other.region, other.type, other.approach):
            return entry.id
    return None


def _taught(state: State, lesson: Lesson) -> State:
    name = speaks_for(state.entries, lesson)
    if name is None:
        lessons = (*state.quarantine.get(lesson.key, ()), lesson)
        return State(state.entries, {**state.quarantine, lesson.key: lessons}, state.refused)
    entry = state.entries[name]
    failures = dict(entry.failures)
    if not lesson.success:
        failure = lesson.failure or "UNKNOWN"
        failures[failure] = failures.get(failure, 0) + 1
    trials, good = entry.n_trials + 1, entry.n_success + int(lesson.success)
    counted = entry.model_copy(
        update={
            "n_trials": trials,
            "n_success": good,
            # What was learnt may be unlearnt; what was built by physical trials stays what it is.
            "success": 2 * good >= trials if name.startswith(LEARNT) else entry.success,
            "failures": dict(sorted(failures.items())),
        }
    )
    return State({**state.entries, name: counted}, state.quarantine, state.refused)


def posterior_mean(entry: Experience) -> float:
    """Mean of the Beta posterior over an entry's success rate, from a flat prior: in (0, 1)."""
    return (1.0 + entry.n_success) / (2.0 + entry.n_trials)


def is_learning(path: Path) -> bool:
    """Whether a path is the folder of a learning knowledge base."""
    return (path / JOURNAL).is_file()


def open_any(path: Path | None) -> ExperienceStore:
    """A knowledge base for reading: a file, a learning folder, or the shipped one.

    Raises:
        EnvironmentFaultError: it cannot be read.
        BadInputError: it is damaged.
    """
    if path is not None and path.is_dir():
        return LearnedBase.open(path).store()
    return ExperienceStore.open(path)


def differences(old: State, new: State) -> Iterable[str]:
    """What changed between two states, in lines."""
    for name in sorted({*old.entries, *new.entries}):
        before, now = old.entries.get(name), new.entries.get(name)
        if before is None and now is not None:
            yield f"+ {name}: {now.n_success}/{now.n_trials}"
        elif now is None and before is not None:
            yield f"- {name}: {before.n_success}/{before.n_trials}"
        elif before is not None and now is not None and before != now:
            yield f"  {name}: {before.n_success}/{before.n_trials} -> {now.n_success}/{now.n_trials}"
    for key in sorted({*old.quarantine, *new.quarantine}):
        count, now_count = len(old.quarantine.get(key, ())), len(new.quarantine.get(key, ()))
        if count != now_count:
            yield f"? {key}: {count} -> {now_count} lessons in quarantine"
