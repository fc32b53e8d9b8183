"""A learning knowledge base: quarantine, promotion, refusal, versions, and what survives damage and kills."""

from __future__ import annotations

import errno
import os
import random
import signal
import subprocess
import sys
import threading
import zlib
from pathlib import Path
from typing import Any

import pytest

from kb.errors import BadInputError, EnvironmentFaultError
from kb.experience import Experience
from kb.journal import JOURNAL, Journal
from kb.learned import LearnedBase, differences, open_any, posterior_mean
from kb.lesson import Lesson, distinct_poses
from kb.priors import prior
from kb.store import ExperienceStore
from tests.learning_fixtures import make_lesson
from tools.learn_experience import LearnRules, Suite, learn_experience, make_suite, works_mostly

PLACES = [(0.4, 0.0), (0.5, 0.1), (0.6, -0.1), (0.45, 0.2), (0.55, -0.2)]


@pytest.fixture(autouse=True)
def _index_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAGVLM_CACHE", "memory")


@pytest.fixture(scope="module")
def suite() -> Suite:
    return make_suite(ExperienceStore.open())


def lessons(count: int, category: str = "cup", **changes: Any) -> list[Lesson]:
    return [make_lesson(category, place=PLACES[i], seed=i, **changes) for i in range(count)]


def promoted(base: LearnedBase) -> list[Experience]:
    return [change.entry for change in base.journal.changes if change.kind == "promoted" and change.entry is not None]


def test_three_confirmed_successes_in_distinct_poses_promote(tmp_path: Path, suite: Suite) -> None:
    """Two are not enough, nor three in one pose; the third in another pose makes an entry that retrieval sees."""
    base = LearnedBase.begin(tmp_path / "kb", empty=True)
    learn_experience([make_lesson(place=(0.5, 0.001 * i), seed=i) for i in range(5)], base, suite)
    assert promoted(base) == []
    learn_experience([make_lesson(place=(0.4, 0.1), seed=7)], base, suite)
    assert len(base.store()) == 0
    learn_experience([make_lesson(place=(0.5, 0.0), yaw=1.0, seed=8)], base, suite)
    (entry,) = promoted(base)
    assert (entry.n_success, entry.n_trials, entry.success) == (7, 7, True)
    assert [e.id for e in base.store().all()] == [entry.id]
    assert base.state.quarantine == {}


def test_a_claim_without_confirmation_counts_against(tmp_path: Path, suite: Suite) -> None:
    """Two unconfirmed claims promote nothing; with them, three confirmed ones are too few."""
    base = LearnedBase.begin(tmp_path / "kb", empty=True)
    learn_experience(lessons(2, confirmed=False), base, suite)
    learn_experience(lessons(3), base, suite)
    assert promoted(base) == []
    key = make_lesson().key
    assert [one.success for one in base.state.quarantine[key]] == [False] * 2 + [True] * 3


def test_failures_are_kept_as_something_to_avoid(tmp_path: Path) -> None:
    """Three failures in distinct poses make an entry with y = 0; an entry that later fails more often than not, too."""
    base, free = LearnedBase.begin(tmp_path / "kb", empty=True), Suite(queries=())
    learn_experience(lessons(3, success=False), base, free)
    (negative,) = base.store().all()
    assert (negative.success, negative.n_success, negative.n_trials, negative.failures) == (False, 0, 3, {"SLIP": 3})
    learn_experience(lessons(3, "mug"), base, free)
    learn_experience([make_lesson("mug", success=False)] * 4, base, free)
    spoiled = base.store().get(make_lesson("mug").key)
    assert (spoiled.n_success, spoiled.n_trials, spoiled.success) == (3, 7, False)


def test_posterior_probability_by_hand() -> None:
    """P(Beta(4, 1) > 1/2) = 15/16, P(Beta(1, 1) > 1/2) = 1/2, P(Beta(6, 2) > 1/2) = 120/128."""
    assert works_mostly(3, 0) == pytest.approx(15 / 16)
    assert works_mostly(0, 0) == pytest.approx(0.5)
    assert works_mostly(5, 1) == pytest.approx(120 / 128)
    assert works_mostly(0, 3) == pytest.approx(1 / 16)


def test_strategies_that_never_work_are_not_promoted_by_lies(tmp_path: Path) -> None:
    """With 20 % of claims and of confirmations false, none of 30 useless strategies tried 10 times each is promoted."""
    base, rng = LearnedBase.begin(tmp_path / "kb", empty=True), random.Random(5)
    for kind in range(30):
        for trial in range(10):
            claimed = rng.random() < 0.2
            confirmed = claimed and rng.random() < 0.2
            place = (0.3 + 0.04 * trial, 0.0)
            lesson = make_lesson(f"k{kind}", place=place, claimed=claimed, confirmed=confirmed, seed=trial)
            learn_experience([lesson], base, Suite(queries=()))
    assert [entry.id for entry in promoted(base) if entry.success] == []
    assert not any(entry.success for entry in base.store().all())


def test_a_promotion_that_harms_retrieval_is_refused(tmp_path: Path) -> None:
    """Bowls held at the body that look like the query would be the first answer instead of the rim: refused, and looked
    at again only after a further lesson."""
    base = LearnedBase.begin(tmp_path / "kb")
    rim = prior("bowl").affordance
    strategy = make_lesson().strategy.model_copy(update={"region": "body"})
    wrong = lessons(3, "bowl", like="bowl", strategy=strategy)
    suite = Suite(queries=(("bowl", rim, wrong[0].embedding),))
    before, count = suite.score(base.store()), len(base.store())
    assert before[0] == 1.0
    last = learn_experience(wrong, base, suite)[-1]
    assert (last.kind, len(base.store()), suite.score(base.store())) == ("refused", count, before)
    assert (
        learn_experience([wrong[0].model_copy(update={"claimed": False, "confirmed": False})], base, suite)[-1].kind
        == "lesson"
    )
    assert learn_experience([wrong[1].model_copy(update={"place": (0.7, 0.2)})], base, suite)[-1].kind in (
        "lesson",
        "refused",
    )


def test_outcomes_of_a_used_entry_move_its_posterior(tmp_path: Path, suite: Suite) -> None:
    """Five failures of a strategy that came from an entry count for that entry, which stays what it was otherwise."""
    base = LearnedBase.begin(tmp_path / "kb")
    entry = base.store().all()[0]
    bad = make_lesson(entry.category, success=False, strategy=entry.strategy, used=entry.id)
    learn_experience([bad] * 5, base, suite)
    after = base.store().get(entry.id)
    assert (after.n_trials, after.n_success) == (entry.n_trials + 5, entry.n_success)
    assert after.success == entry.success
    assert posterior_mean(after) < posterior_mean(entry)
    assert base.state.quarantine == {}


def test_every_version_can_be_had_again(tmp_path: Path, suite: Suite) -> None:
    """Rolled back, the entries are those of that version; the rollback can be rolled back; nothing is forgotten."""
    base = LearnedBase.begin(tmp_path / "kb", empty=True)
    learn_experience(lessons(3), base, suite)
    newest = base.version
    assert list(differences(base.at(0), base.at(newest))) == [f"+ {make_lesson().key}: 3/3"]
    base.rollback(0)
    assert len(base.store()) == 0
    base.rollback(newest)
    again = LearnedBase.open(tmp_path / "kb")
    assert (len(again.store()), again.version) == (1, newest + 2)
    with pytest.raises(BadInputError, match="no version 99"):
        again.rollback(99)


def test_two_learners_take_turns(tmp_path: Path) -> None:
    """Two learners on one folder at once: all lessons of both are there, numbered without gaps, and both see them."""
    one = LearnedBase.begin(tmp_path / "kb", empty=True)
    two = LearnedBase.open(tmp_path / "kb")
    empty = Suite(queries=())

    def teach(base: LearnedBase, name: str) -> None:
        for i in range(20):
            learn_experience([make_lesson(f"{name}{i}", seed=i)], base, empty)

    workers = [threading.Thread(target=teach, args=(base, name)) for base, name in ((one, "a"), (two, "b"))]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    both = LearnedBase.open(tmp_path / "kb")
    assert len(both.state.quarantine) == 40
    assert [change.version for change in both.journal.changes] == list(range(41))


def test_damage_is_told_in_one_line_and_changes_nothing(tmp_path: Path) -> None:
    """A torn last line is cut off by the next writer; a damaged one before, another format, or a folder without journal
    is an error in one line; the file stays as it was."""
    folder = tmp_path / "kb"
    base = LearnedBase.begin(folder, empty=True)
    learn_experience(lessons(2), base, Suite(queries=()))
    path = folder / JOURNAL
    whole = path.read_bytes()
    path.write_bytes(whole + b'0badc0de {"version": 3, "ki')
    torn = LearnedBase.open(folder)
    assert torn.version == 2
    learn_experience(lessons(1, "mug"), torn, Suite(queries=()))
    assert path.read_bytes().startswith(whole)
    assert LearnedBase.open(folder).version == 3
    damaged = whole.replace(b'"cup"', b'"cap"', 1)
    other = whole.replace(b"ragvlm-journal-1", b"ragvlm-journal-9", 1)
    first, rest = other.split(b"\n", 1)
    text = first.partition(b" ")[2]
    foreign = f"{zlib.crc32(text):08x} ".encode() + text + b"\n" + rest
    for content, word in ((damaged, "damaged"), (b"\n" + whole, "damaged"), (foreign, "journal-9")):
        path.write_bytes(content)
        with pytest.raises(EnvironmentFaultError, match=word) as caught:
            LearnedBase.open(folder)
        assert "\n" not in str(caught.value)
        assert path.read_bytes() == content
    with pytest.raises(BadInputError, match="no learning knowledge base in"):
        LearnedBase.open(tmp_path / "nothing")


def test_a_read_only_folder_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that may not be written can be read; writing ends in one line with the mend and changes nothing."""
    folder = tmp_path / "kb"
    base = LearnedBase.begin(folder, empty=True)
    content = (folder / JOURNAL).read_bytes()

    def refuse(*_: Any) -> int:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr("kb.journal.os.open", refuse)
    assert len(open_any(folder)) == 0
    with pytest.raises(EnvironmentFaultError, match="cannot be written: Read-only file system; give a folder"):
        learn_experience(lessons(1), base, Suite(queries=()))
    assert (folder / JOURNAL).read_bytes() == content


def kill_and_check(folder: Path, rng: random.Random, first: int) -> int:
    """Starts a learner, kills it at a random moment, and checks that every acknowledged change is there."""
    script = Path(__file__).with_name("killed_learner.py")
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    process = subprocess.Popen(
        [sys.executable, str(script), str(folder), str(first)], stdout=subprocess.PIPE, text=True, env=environment
    )
    assert process.stdout is not None
    assert process.stdout.readline().strip() == "ready"
    said: list[str] = []
    wanted = rng.randint(1, 25)
    killer = threading.Timer(rng.uniform(0.001, 0.02), lambda: process.send_signal(signal.SIGKILL))
    for line in process.stdout:
        if line.endswith("\n"):
            said.append(line.strip())
        if len(said) == wanted:
            killer.start()
    killer.cancel()
    process.wait()
    kept = {change.version: f"{change.version} {change.kind} {change.says}" for change in Journal(folder).changes}
    for line in said:
        assert kept[int(line.split(" ", 1)[0])] == line
    return first + 3 * (len(said) + 3)


def test_killed_learners_lose_nothing_that_was_acknowledged(tmp_path: Path) -> None:
    """Kill -9 at three random points while promotions are written: every acknowledged change is in the journal."""
    rng, first = random.Random(1), 0
    for _ in range(3):
        first = kill_and_check(tmp_path / "kb", rng, first)
    assert promoted(LearnedBase.open(tmp_path / "kb"))


@pytest.mark.long
def test_twenty_kills_lose_nothing(tmp_path: Path) -> None:
    """The same at twenty random points, one after the other in one knowledge base."""
    rng, first = random.Random(2), 0
    for _ in range(20):
        first = kill_and_check(tmp_path / "kb", rng, first)


def test_poses_are_distinct_by_place_or_turn() -> None:
    """3 cm apart or turned by 20 degrees is another pose; half a turn is the same one."""
    one = make_lesson()
    near, far = make_lesson(place=(0.52, 0.0)), make_lesson(place=(0.54, 0.0))
    turned, around = make_lesson(yaw=0.5), make_lesson(yaw=3.1)
    assert distinct_poses([one, near, around]) == [one]
    assert distinct_poses([one, far, turned]) == [one, far, turned]


def test_rules_are_adjustable(tmp_path: Path) -> None:
    """With N = 2 and a lower probability two successes are enough."""
    base = LearnedBase.begin(tmp_path / "kb", empty=True)
    learn_experience(lessons(2), base, Suite(queries=()), LearnRules(needed=2, sure=0.8))
    assert len(promoted(base)) == 1
