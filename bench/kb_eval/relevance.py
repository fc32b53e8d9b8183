"""Which entries are relevant for an object: by label (R-aff) and by doing (R-func, R-grade).

R-func is measured: an entry's strategy is carried out on ten drawn instances of the query's object in contact physics,
at the object's region of the same name, with the entry's own force; at least seven must succeed. Outcomes are kept in a
file beside the knowledge base, keyed by object and strategy, and executed anew where the strategy changed. Entries that
failed when they were learnt are never relevant.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kb.affordance import AffordanceDescriptor
from kb.errors import EnvironmentFaultError
from kb.experience import Experience, Strategy
from tools.experience.recipe import Recipe
from tools.experience.trial import run_trial

TRIALS, ENOUGH = 10, 7
FIRST_SEED = 18_500
"""Seeds of the executed instances; not those of the queries, and below the benchmark's."""
FRAGILITY = 0.2
"""R-aff wants the same type and region and a fragility this near."""

Progress = Callable[[int, int, str], None]


class FunctionalRelevance:
    """Successes of ten per (object, strategy), read from a file and filled on demand."""

    def __init__(self, path: Path, *, again: bool = False) -> None:
        """Reads the file; `again` leaves it aside and executes everything anew.

        Raises:
            EnvironmentFaultError: the file is damaged.
        """
        self._path = path
        self._rates: dict[str, int] = {}
        self.code = code_digest()
        """Digest of the code that executed the outcomes; "mixed" if several versions did."""
        if path.exists() and not again:
            try:
                kept = json.loads(path.read_text())
                self._rates = {str(key): int(value) for key, value in kept["successes"].items()}
                if self._rates and kept.get("code") != self.code:
                    self.code = "mixed"
            except (OSError, ValueError, KeyError, AttributeError) as error:
                what = f"the executed outcomes {path} cannot be read: {error}"
                raise EnvironmentFaultError(what, mend=f"delete {path}, and they are executed again") from error

    def rate(self, model: str, entry: Experience) -> float | None:
        """Share of ten executions that succeeded; None if they were not executed."""
        found = self._rates.get(key_of(model, entry.strategy))
        return None if found is None else found / TRIALS

    def missing(self, pairs: Iterable[tuple[str, Experience]]) -> list[tuple[str, Experience]]:
        """Those pairs of object and entry that were not executed yet; one of each strategy, failures left out."""
        found: dict[str, tuple[str, Experience]] = {}
        for model, entry in pairs:
            if entry.success and (key := key_of(model, entry.strategy)) not in self._rates:
                found.setdefault(key, (model, entry))
        return list(found.values())

    def fill(self, pairs: list[tuple[str, Experience]], progress: Progress | None = None, workers: int = 1) -> None:
        """Executes the pairs and writes the file now and then, so that an interrupted one goes on from there."""
        jobs = [(model, entry.strategy) for model, entry in pairs]
        if workers <= 1 or len(jobs) < 2:
            self._collect(pairs, map(_executed, jobs), progress)
            return
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            self._collect(pairs, pool.map(_executed, jobs, chunksize=4), progress)

    def _collect(self, pairs: list[tuple[str, Experience]], results: Iterable[int], progress: Progress | None) -> None:
        for done, ((model, entry), found) in enumerate(zip(pairs, results, strict=True), start=1):
            self._rates[key_of(model, entry.strategy)] = found
            if progress is not None:
                progress(done, len(pairs), f"{entry.id} executed on {model}")
            if done == len(pairs) or done % 50 == 0:
                self._save()

    def _save(self) -> None:
        try:
            kept = {"trials": TRIALS, "code": self.code, "successes": dict(sorted(self._rates.items()))}
            text = json.dumps(kept, indent=0)
            building = self._path.with_name(f".{self._path.name}.new")
            building.write_text(text + "\n")
            building.replace(self._path)
        except OSError as error:
            what = f"the executed outcomes cannot be written to {self._path}: {error.strerror}"
            raise EnvironmentFaultError(what, mend="give a path that can be written: --executed FILE") from error


@cache
def code_digest() -> str:
    """Digest of the sources of the world and of the trials: outcomes of other code may differ."""
    import sim
    import tools.experience

    digest = hashlib.sha256()
    for package in (sim, tools.experience):
        for file in sorted(Path(str(package.__file__)).parent.rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def key_of(model: str, strategy: Strategy) -> str:
    """Object and digest of the strategy; the force band and the opening do not matter, as both are adapted."""
    numbers = (round(strategy.tilt, 2), round(strategy.force, 1), round(strategy.depth, 2), round(strategy.speed, 2))
    text = f"{strategy.region} {strategy.type} {strategy.approach} {numbers}"
    return f"{model} {hashlib.sha256(text.encode()).hexdigest()[:12]}"


def _executed(job: tuple[str, Strategy]) -> int:
    return successes(*job)


def successes(model: str, strategy: Strategy) -> int:
    """How many of ten executions of a strategy on instances of a model succeed, by the observer."""
    recipe = Recipe(
        name="retrieved",
        region=strategy.region,
        type=strategy.type,
        approach=strategy.approach,
        tilt=math.degrees(strategy.tilt),
        force=float(np.clip(strategy.force, 1.0, 70.0)),
        depth=strategy.depth,
        speed=float(np.clip(strategy.speed, 0.1, 1.0)),
    )
    return sum(run_trial(model, recipe, FIRST_SEED + number, recipe.force).success for number in range(TRIALS))


def affordance_relevant(true: AffordanceDescriptor, entries: Iterable[Experience]) -> NDArray[np.bool_]:
    """R-aff: successes of the same type and region with a fragility within 0.2."""
    return np.array(
        [
            entry.success
            and entry.affordance.type == true.type
            and entry.affordance.region == true.region
            and abs(entry.affordance.fragility - true.fragility) <= FRAGILITY + 1e-9
            for entry in entries
        ],
        np.bool_,
    )


def gains(model: str, entries: Iterable[Experience], executed: FunctionalRelevance) -> NDArray[np.float64]:
    """R-grade: the success rate of every entry on the object; 0 for entries that failed, NaN where not executed."""
    rates = [executed.rate(model, entry) if entry.success else 0.0 for entry in entries]
    return np.array([math.nan if rate is None else rate for rate in rates])
