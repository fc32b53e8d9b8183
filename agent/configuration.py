"""Configurations: names for what takes part, as values composed of switches (benchmark section 8), not forks of code."""

from __future__ import annotations

from collections.abc import Iterable

from kb.base import Noun
from kb.errors import BadInputError
from kb.switches import Switches
from kb.vocabulary import PerceptionName


class Configuration(Noun):
    """One row of the benchmark's table."""

    name: str
    switches: Switches
    says: str
    """One line for people."""
    perception: PerceptionName | None = None
    """Perception that this configuration prescribes, whatever was asked for."""


_HEURISTIC = Switches(
    retrieval="none", prior="heuristic", scene_graph=False, constraints=False, memory=False, clearance=False
)
_BARE = Switches(
    retrieval="none",
    prior="default",
    scene_graph=False,
    constraints=False,
    recovery=False,
    memory=False,
    geometric_candidates=False,
    clearance=False,
)

CONFIGURATIONS: dict[str, Configuration] = {
    row.name: row
    for row in (
        Configuration(name="full", switches=Switches(), says="everything"),
        Configuration(name="no_recovery", switches=Switches(recovery=False), says="a single attempt per goal"),
        Configuration(name="no_memory", switches=Switches(memory=False), says="without episodic memory"),
        Configuration(
            name="no_scene_graph",
            switches=Switches(scene_graph=False, constraints=False, clearance=False),
            says="without scene graph, constraints and clearance scoring",
        ),
        Configuration(
            name="no_haarag",
            switches=Switches(retrieval="none", prior="default"),
            says="a fixed prior on region, type and force (the middle, a power grasp, 20 N) instead of retrieved experience",
        ),
        Configuration(
            name="vlm_only",
            switches=_BARE,
            says="perception alone; without a vision-language model a fixed default grasp (straight down at the middle, 20 N)",
        ),
        Configuration(name="heuristic", switches=_HEURISTIC, says="size and fragility rules with recovery"),
        Configuration(
            name="no_constraints",
            switches=Switches(constraints=False),
            says="scene graph without the adjustment (the paper's Table V)",
        ),
        Configuration(
            name="heuristic_scene_graph",
            switches=_HEURISTIC.model_copy(update={"scene_graph": True, "constraints": True, "clearance": True}),
            says="heuristic with scene graph and constraints: the rival to beat",
        ),
        Configuration(
            name="heuristic_scene_graph_memory",
            switches=_HEURISTIC.model_copy(
                update={"scene_graph": True, "constraints": True, "clearance": True, "memory": True}
            ),
            says="heuristic with scene graph, constraints and memory",
        ),
        Configuration(
            name="blind_retry",
            switches=Switches(diagnosis_used=False),
            says="as many attempts, no diagnosis: a fresh draw each time",
        ),
        Configuration(
            name="paper_literal",
            switches=Switches(
                levels="as_written",
                away="motion",
                distance="centre",
                strict_l1=True,
                geometric_candidates=False,
                clearance=False,
            ),
            says="constants and levels exactly as printed, no geometric candidates",
        ),
        Configuration(
            name="random_in_category",
            switches=Switches(retrieval="random_in_category"),
            says="a random experience of the category instead of the best",
        ),
        Configuration(
            name="full_blind",
            switches=Switches(taxonomy="blind"),
            says="everything, with a taxonomy that has no name of the far out-of-distribution objects",
        ),
        Configuration(
            name="geometry_only",
            switches=Switches(retrieval="none", prior="geometry", memory=False),
            says="antipodal geometry alone, no prior on region, type or force",
        ),
        Configuration(name="oracle_perception", switches=Switches(), says="true poses and kinds", perception="oracle"),
        Configuration(
            name="oracle_phi",
            switches=Switches(diagnosis="oracle_phi"),
            says="failure types told by the evaluator, as the paper does",
        ),
        Configuration(
            name="levels_as_written",
            switches=Switches(levels="as_written"),
            says="correction levels as printed, by which level 3 never runs",
        ),
    )
}
"""Name -> configuration."""


PAPER = ("full", "no_recovery", "no_memory", "no_scene_graph", "heuristic", "no_haarag", "vlm_only")
"""The seven rows of the paper's Table II."""


def names_of(words: Iterable[str]) -> tuple[str, ...]:
    """Names of configurations from names and the words "paper" and "all", each once, in order.

    Raises:
        BadInputError: unknown name; the message lists the known ones.
    """
    groups = {"paper": PAPER, "all": tuple(CONFIGURATIONS)}
    return tuple(dict.fromkeys(name for word in words for name in (groups.get(word) or (configuration(word).name,))))


def configuration(name: str) -> Configuration:
    """The configuration of that name.

    Raises:
        BadInputError: unknown name; the message lists the known ones.
    """
    if name not in CONFIGURATIONS:
        raise BadInputError(f"unknown configuration {name!r}", choices=CONFIGURATIONS)
    return CONFIGURATIONS[name]
