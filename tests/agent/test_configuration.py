"""Configurations are values; their names are the benchmark's."""

from __future__ import annotations

import pytest

from agent.build_agent import brain_named, build_agent
from agent.configuration import CONFIGURATIONS, configuration
from kb.errors import BadInputError, EnvironmentFaultError
from kb.switches import Switches

NAMES = {
    "full", "no_recovery", "no_memory", "no_scene_graph", "no_haarag", "vlm_only", "heuristic", "no_constraints",
    "heuristic_scene_graph", "heuristic_scene_graph_memory", "blind_retry", "paper_literal", "random_in_category",
    "geometry_only", "oracle_perception", "oracle_phi",
}  # fmt: skip


def test_all_names_of_the_benchmark_exist() -> None:
    """Each row of the table has a configuration."""
    assert set(CONFIGURATIONS) >= NAMES


def test_full_is_the_default() -> None:
    """The full configuration is all switches at their defaults."""
    assert configuration("full").switches == Switches()


def test_ablations_change_what_they_name() -> None:
    """Each ablation differs from full in its own switch; blind retry in the diagnosis alone."""
    assert not configuration("no_recovery").switches.recovery
    assert not configuration("no_memory").switches.memory
    assert not configuration("no_scene_graph").switches.scene_graph
    assert configuration("blind_retry").switches == Switches(diagnosis_used=False)
    assert configuration("heuristic").switches.recovery
    assert configuration("oracle_perception").perception == "oracle"


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"configuration": "fully"}, "full"),
        ({"brain": "gpt"}, "rules"),
        ({"perception": "lidar"}, "rgbd"),
        ({"evaluator": "isaac"}, "mujoco"),
        ({"scene": "no_such_scene"}, "single_cup"),
    ],
)
def test_unknown_names_list_the_valid_ones(options: dict[str, str], word: str) -> None:
    """Every option that is a name refuses an unknown one with the choices."""
    with pytest.raises(BadInputError, match=word):
        build_agent(**options)  # type: ignore[arg-type]


def test_brains_that_are_not_here_say_the_mend() -> None:
    """A language model that cannot be had is an environment fault."""
    with pytest.raises(EnvironmentFaultError, match="--brain rules"):
        brain_named("hf:some/model")
