"""Learning from nothing: a robot with an empty knowledge base beside one with the shipped one, in the same worlds.

    python -m bench.learn_study --trials 500 --out runs/learn             # physics, about two hours on one core
    python -m bench.learn_study --trials 500 --false-claims 0.2 --out runs/learn_false

Each trial puts one of the twelve objects of Table I somewhere and asks for it. The learner enters what it sensed; every
claimed success is confirmed by setting down and lifting again. `--false-claims` turns that share of its failed attempts,
and of its failed confirmations, into claims of success. The observer is asked only for this study's numbers.
"""

from __future__ import annotations

import argparse
import json
import logging
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from bench.kb_eval.query import IN_DISTRIBUTION
from kb.base import Noun
from kb.errors import BadInputError, RagVlmError
from kb.learned import LearnedBase
from kb.store import ExperienceStore
from kb.vocabulary import EvaluatorName, PerceptionName
from tools.learn_experience import LearnRules, learn_experience, make_suite

log = logging.getLogger(__name__)

FIRST_SEED = 15_000
"""Seeds of the study's worlds (tuning range)."""
SCENE = """name: study_{model}
objects:
  - {{id: thing, model: {model}}}
randomise: {{position: 0.12, yaw: 3.1416, size: 0.05, mass: 0.2, friction: 0.2}}
"""


@dataclass(frozen=True)
class Taken:
    """One trial of one arm."""

    trial: int
    model: str
    seed: int
    success: bool
    """By the observer."""
    claimed: bool
    """By the robot, with what was injected."""
    attempts: int
    confirmed: bool = False
    truly_again: bool = False
    """The second lift succeeded by the observer."""
    promoted: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    entries: int = 0
    """Entries of the knowledge base after the trial."""
    error: str = ""


class Asked(Noun):
    """What the study is asked for."""

    trials: int = 500
    evaluator: EvaluatorName = "mujoco"
    perception: PerceptionName = "rgbd"
    false_claims: float = 0.0
    needed: int = 3
    first_seed: int = FIRST_SEED
    attempts: bool = True
    """Up to four attempts as in `full`; False: one."""


def world_of(asked: Asked, trial: int) -> tuple[str, int]:
    """Model and seed of a trial: the twelve in turns."""
    return IN_DISTRIBUTION[trial % len(IN_DISTRIBUTION)], asked.first_seed + trial


def run_arm(asked: Asked, out: Path, learner: bool) -> list[Taken]:
    """All trials of one arm, in order; the lines of a folder that is there already are kept and gone on from.

    Args:
        asked: The study.
        out: Folder of the arm: trials.jsonl, and the knowledge base of the learner.
        learner: Begin empty and learn; else the shipped knowledge base as it is.
    """
    out.mkdir(parents=True, exist_ok=True)
    file = out / "trials.jsonl"
    taken = [_taken(json.loads(line)) for line in file.read_text().splitlines()] if file.exists() else []
    base = LearnedBase.begin(out / "kb", empty=True) if learner else None
    suite = make_suite(ExperienceStore.open())
    with tempfile.TemporaryDirectory() as scenes, file.open("a") as stream:
        for trial in range(len(taken), asked.trials):
            row = run_trial(asked, trial, Path(scenes), base, suite)
            stream.write(json.dumps(asdict(row)) + "\n")
            stream.flush()
            taken.append(row)
            log.info("%s %d/%d: %s", out.name, trial + 1, asked.trials, row)
    return taken


def _taken(row: dict[str, Any]) -> Taken:
    return Taken(**{**row, "promoted": tuple(row["promoted"]), "refused": tuple(row["refused"])})


def run_trial(asked: Asked, trial: int, scenes: Path, base: LearnedBase | None, suite: Any) -> Taken:
    """One world: ask for the object, and let the learner learn."""
    from agent import build_agent
    from agent.lessons import confirm, lessons_of

    model, seed = world_of(asked, trial)
    scene = scenes / f"{model}.yaml"
    scene.write_text(SCENE.format(model=model))
    rng = np.random.default_rng([seed, 41])
    store = ExperienceStore.open() if base is None else base.store()
    try:
        agent = build_agent(
            scene=str(scene), seed=seed, perception=asked.perception, evaluator=asked.evaluator,
            configuration="full" if asked.attempts else "no_recovery", store=store,
        )  # fmt: skip
        context = agent.context
        context.tools.switches = context.tools.switches.model_copy(update={"learn": base is not None})
        result = agent.run(instruction(model))
    except RagVlmError as error:
        return Taken(trial, model, seed, False, False, 0, error=str(error))
    attempts = agent.state.attempts
    if not attempts or base is None:
        claimed = bool(attempts) and attempts[-1].claimed
        return Taken(trial, model, seed, result.success, claimed, len(attempts))
    attempts = tuple(_injected(a, asked.false_claims, rng) for a in attempts)
    last, again = attempts[-1], False
    confirmed: bool | None = False
    if last.claimed:
        word = confirm(last, context.tools)
        lie = bool(rng.random() < asked.false_claims)
        confirmed = word.confirmed or lie if word.lift is not None or lie else None
        again = bool(word.lift) and agent.opened.observer.judge(agent.opened.motions, "thing").success
    lessons = lessons_of(attempts, confirmed, store.embedder_name, seed)
    changes = learn_experience(lessons, base, suite, LearnRules(needed=asked.needed))
    return Taken(
        trial, model, seed, result.success, last.claimed, len(attempts), bool(confirmed), again,
        tuple(c.key for c in changes if c.kind == "promoted"), tuple(c.key for c in changes if c.kind == "refused"),
        len(base.state.entries),
    )  # fmt: skip


def _injected(attempt: Any, share: float, rng: np.random.Generator) -> Any:
    """An attempt whose honest failure may be turned into a claim."""
    lie = not attempt.claimed and rng.random() < share
    return attempt.model_copy(update={"claimed": True, "failure": None}) if lie else attempt


def instruction(model: str) -> str:
    """What is asked for, by the object's kind."""
    from sim.catalogue import MODELS

    return f"pick up the {MODELS[model].category.replace('_', ' ')}"


def say(line: str) -> None:
    """One line on standard output, at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of `python -m bench.learn_study`."""
    from bench.learn_report import write_report

    parser = argparse.ArgumentParser(prog="python -m bench.learn_study", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--trials", type=int, default=500)
    parser.add_argument("--evaluator", choices=("mujoco", "analytic"), default="mujoco")
    parser.add_argument("--perception", choices=("rgbd", "oracle"), default="rgbd")
    parser.add_argument("--false-claims", type=float, default=0.0)
    parser.add_argument("--needed", type=int, default=3, help="independent successes for a promotion")
    parser.add_argument("--one-attempt", action="store_true")
    parser.add_argument("--workers", type=int, default=2, help="2: both arms at the same time")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args(arguments)
    if not 0.0 <= given.false_claims <= 1.0 or given.trials < 1:
        raise BadInputError("a share is between 0 and 1, and there is at least one trial", where="--false-claims")
    asked = Asked(
        trials=given.trials, evaluator=given.evaluator, perception=given.perception, needed=given.needed,
        false_claims=given.false_claims, attempts=not given.one_attempt,
    )  # fmt: skip
    arms = [(asked, given.out / "learner", True), (asked, given.out / "shipped", False)]
    if given.workers > 1:
        with ProcessPoolExecutor(2, mp_context=get_context("spawn"), initializer=_logging) as pool:
            learner, shipped = [future.result() for future in [pool.submit(run_arm, *arm) for arm in arms]]
    else:
        learner, shipped = [run_arm(*arm) for arm in arms]
    say(write_report(asked, learner, shipped, given.out))
    return 0


def _logging() -> None:
    logging.basicConfig(level=logging.WARNING, format="%(message)s")
    log.setLevel(logging.INFO)


if __name__ == "__main__":
    _logging()
    try:
        sys.exit(main())
    except RagVlmError as error:
        sys.exit(f"learn_study: error: {error}")
