"""`ragvlm kb log|diff|rollback|add`, and learning after a run: the command line's side of a learning knowledge base."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kb.errors import BadInputError, EnvironmentFaultError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.build_agent import Agent
    from agent.events import BaseStep
    from app.options import RunOptions
    from kb.journal import Change
    from kb.learned import LearnedBase
    from tools.learn_experience import Suite


def default_folder() -> Path:
    """Folder of the learning knowledge base: `$RAGVLM_HOME/knowledge`, or in the user's data folder."""
    home = os.environ.get("RAGVLM_HOME")
    if home:
        return Path(home) / "knowledge"
    base = os.environ.get("XDG_DATA_HOME") or str(Path.home() / ".local" / "share")
    return Path(base) / "ragvlm" / "knowledge"


def print_log(folder: Path, *, everything: bool, json_output: bool) -> None:
    """The changes, newest last; lessons only if asked for."""
    from kb.learned import LearnedBase

    base = LearnedBase.open(folder)
    shown = [change for change in base.journal.changes if everything or change.kind != "lesson"]
    if json_output:
        print(json.dumps([_row(change) for change in shown], indent=2))
        return
    for change in shown:
        print(f"{change.version:>6}  {change.kind:<12}{change.says}")
    lessons = sum(change.kind == "lesson" for change in base.journal.changes)
    waiting = sum(len(kept) for kept in base.state.quarantine.values())
    print(f"version {base.version}: {_entries(base)}, {lessons} lessons, {waiting} in quarantine")


def _entries(base: LearnedBase) -> str:
    count = len(base.state.entries)
    return f"{count} entr{'y' if count == 1 else 'ies'}"


def _row(change: Change) -> dict[str, Any]:
    row = change.model_dump(mode="json", exclude_defaults=True)
    for part in ("lesson", "entry"):
        if "embedding" in row.get(part, {}):
            row[part]["embedding"] = f"{len(row[part]['embedding'])} numbers"
    return row | {"version": change.version}


def print_diff(folder: Path, old: int, new: int | None) -> None:
    """What changed between two versions.

    Raises:
        BadInputError: there is no such version.
    """
    from kb.learned import LearnedBase, differences

    base = LearnedBase.open(folder)
    for line in differences(base.at(old), base.at(base.version if new is None else new)):
        print(line)


def roll_back(folder: Path, version: int) -> None:
    """Goes back to a version.

    Raises:
        BadInputError: there is no such version.
    """
    from kb.learned import LearnedBase

    base = LearnedBase.open(folder)
    change = base.rollback(version)
    print(f"version {change.version}: {change.says}; {_entries(base)}")


def add_object(folder: Path, name: str, scene: str, thing: str, described: dict[str, Any], trials: int) -> None:
    """Teaches the knowledge base of a folder an object of a scene, by trials in physics.

    Raises:
        BadInputError: the name is taken by known things, or the scene, object or descriptor is wrong.
    """
    from app.console import make_console
    from app.knowledge import check_descriptor
    from kb.journal import Change
    from kb.learned import LearnedBase
    from kb.shape_colour import ShapeColourEmbedder
    from tools.context import ToolContext
    from tools.learn_experience import make_suite
    from tools.teach_object import TeachArgs, check_object, teach_object

    check_descriptor(described)
    if not name.replace("_", "").isalnum():
        raise BadInputError(f'"{name}" is no name', where="NAME", choices=("letters, digits and underscores",))
    check_object(scene, thing)
    base = LearnedBase.begin(folder)
    store = base.store()
    console = make_console(stderr=True)
    entries = teach_object(
        TeachArgs(name=name, scene=scene, object=thing, affordance=described, trials=trials),
        ToolContext(store=store, embedder=ShapeColourEmbedder()),
        lambda done, total, what: console.print(f"{done}/{total} {what}", markup=False),
    )
    for entry in entries:
        with base.journal.writing():
            taken = base.state.entries
            number = sum(key == entry.id or key.startswith(f"{entry.id}-") for key in taken)
            kept = entry if number == 0 else entry.model_copy(update={"id": f"{entry.id}-{number + 1}"})
            _refuse_harm(base, kept, make_suite(store))
            says = f"{kept.id} by {kept.n_trials} trials, {kept.n_success} succeeded"
            change = base.journal.append(Change(version=0, kind="added", says=says, entry=kept))
        print(f"version {change.version}: {change.says}")


def _refuse_harm(base: LearnedBase, entry: Any, suite: Suite) -> None:
    """Raises `BadInputError` if retrieval gets worse by an entry."""
    from kb.store import ExperienceStore

    entries = list(base.state.entries.values())
    old = suite.score(ExperienceStore(base.header, entries))
    new = suite.score(ExperienceStore(base.header, [*entries, entry]))
    if min(b - a for a, b in zip(old, new, strict=True)) < -1e-9:
        raise BadInputError(
            f"{entry.id} would lower retrieval of what is known from {old[0]:.3f} to {new[0]:.3f}; nothing was added",
            where="NAME",
        )


def store_of(options: RunOptions) -> Any:
    """The knowledge base of a session that does not learn: a server's, or the path that was given.

    Raises:
        EnvironmentFaultError: the server cannot be reached or holds no knowledge base.
    """
    if options.kb_url is not None:
        from kb.chroma_server import read_server

        return read_server(options.kb_url)
    return options.kb


class Learner:
    """Enters the outcomes of a session into its learning knowledge base."""

    def __init__(self, options: RunOptions, needed: int = 3) -> None:
        """Opens the knowledge base, or begins one with the shipped one, embedded by the session's embedder.

        Raises:
            EnvironmentFaultError: it is damaged, cannot be written, or was embedded by another embedder.
        """
        from kb.embed_store import embedded_store
        from kb.learned import LearnedBase
        from kb.open_embedder import open_embedder
        from kb.store import ExperienceStore
        from tools.learn_experience import LearnRules, make_suite

        folder = Path(options.kb) if options.kb is not None else default_folder()
        if folder.is_file():
            raise BadInputError(f"{folder} is a file; learning needs a folder", where="--kb")
        embedder = open_embedder(options.embedder)
        shipped = embedded_store(ExperienceStore.open(), embedder)
        self._base = LearnedBase.begin(folder, start=shipped)
        self.store = self._base.store()
        if self.store.embedder_name != embedder.name:
            what = f"{folder} learns with the embedder {self.store.embedder_name!r}, the session uses {embedder.name!r}"
            raise EnvironmentFaultError(what, mend="use that embedder, or another folder: --kb DIR")
        self._suite = make_suite(shipped)
        self._rules = LearnRules(needed=needed)

    def after(self, agent: Agent) -> Iterator[BaseStep]:
        """Enters the attempts of the turn that has just ended and says what came of them.

        A claimed success is confirmed by setting down and lifting again; then the world is as the turn had left it. Who
        wants to be asked before every motion is not surprised by that one: the success is left out of what is learnt.
        """
        from agent.events import Thought
        from agent.lessons import confirm, lessons_of
        from tools.learn_experience import learn_experience

        state = agent.state
        attempts = [attempt for attempt in state.attempts if attempt.turn == state.turn]
        if not attempts or agent.opened.stop.pressed:
            return
        confirmed: bool | None = False
        if attempts[-1].claimed and state.held is not None:
            confirmed = None
            if not agent.context.approve:
                moment = agent.opened.snapshot()
                word = confirm(attempts[-1], agent.context.tools)
                agent.opened.restore(moment)
                confirmed = word.confirmed if word.lift is not None else None
                yield Thought(text=f"To be sure before I learn it, I set it down and lift it again: {word.says}.")
        lessons = lessons_of(attempts, confirmed, self._base.header.embedder, agent.context.seed)
        for change in learn_experience(lessons, self._base, self._suite, self._rules):
            yield Thought(text=f"Knowledge base, version {change.version}, {change.kind}: {change.says}.")
        self.store = agent.context.tools.store = self._base.store()
