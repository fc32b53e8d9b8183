"""Laws of walking the task graph without LangGraph's run time, and of sharing steps between configurations."""

from __future__ import annotations

from typing import Any

import pytest

from bench.job import Job, Settings
from bench.run_job import run_job
from bench.shared_walk import Step, WatchedSwitches, _agree, wiring
from bench.suite import tasks_of
from kb.switches import Switches

ANALYTIC = Settings(seed=11_003, evaluator="analytic", perception="oracle")
NAMES = ("full", "no_recovery", "no_memory", "no_haarag", "vlm_only")
OWN = {"timings_s"}


def rows_of(task: str, *names: str) -> dict[str, dict[str, Any]]:
    """Rows of a trial of the analytic evaluator as plain data."""
    job = Job(
        settings=ANALYTIC, task=tasks_of("tasks", [task])[0], configurations=names, repetition=0, trial=0, seed=11_003,
        noise=1.0,
    )  # fmt: skip
    return {row.configuration: row.model_dump(mode="json") for row in run_job(job)}


@pytest.fixture(scope="module")
def rows() -> dict[str, dict[str, Any]]:
    """Five configurations in one world."""
    return rows_of("cup_near_vase", *NAMES)


def test_a_row_is_the_same_alone(rows: dict[str, dict[str, Any]]) -> None:
    """Taking steps over from an earlier configuration changes nothing but the counts of what was shared."""
    assert rows["full"]["shared_steps"] == 0
    assert rows["no_recovery"]["shared_steps"] > 5
    alone = rows_of("cup_near_vase", "no_memory")["no_memory"]
    apart = OWN | {"wall_s", "shared_steps", "shared_looks", "shared_motions"}
    assert {k: v for k, v in alone.items() if k not in apart} == {
        k: v for k, v in rows["no_memory"].items() if k not in apart
    }


def test_switches_that_were_read_decide() -> None:
    """A step is shared exactly if every switch that it read has the same value; taking all of them reads all."""
    watched = WatchedSwitches(Switches())
    assert watched.memory is True
    assert watched.reads == {"memory": True}
    step = Step(reads=dict(watched.reads), update={}, goes_to="look", seconds=0.0)
    assert _agree(step.reads, Switches(recovery=False))
    assert not _agree(step.reads, Switches(memory=False))
    watched.model_dump()
    assert set(watched.reads) == set(Switches.model_fields)


def test_wiring_is_the_agents_own() -> None:
    """Every node has one way on, and the walk starts where the agent does."""
    graph = wiring()
    assert graph.start == "understand"
    assert set(graph.nodes) == (set(graph.edges) | set(graph.branches)) - {"__start__"}
    assert {"messages", "attempts", "memory", "times"} <= set(graph.reducers)


def test_nothing_is_rendered_for_an_oracle_without_physics(monkeypatch: pytest.MonkeyPatch) -> None:
    """The analytic evaluator with oracle perception takes no picture, and the row still says oracle."""
    from sim.world import World

    def forbidden(*_: Any) -> Any:
        raise AssertionError("a picture was taken")

    monkeypatch.setattr(World, "capture", forbidden)
    row = rows_of("single_cube", "full")["full"]
    assert row["harness_error"] is None
    assert (row["perception"], row["evaluator"]) == ("oracle", "analytic")
    assert row["experiences"], "retrieval still takes place, with a stored view as query"


def test_walks_to_the_same_end_are_judged_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Configurations that ended in the very same state get one judgement, each under its own name."""
    import agent.run_result as module

    judged, real = list[str](), module.run_result

    def counted(*args: Any, **kwargs: Any) -> Any:
        judged.append(kwargs["configuration"])
        return real(*args, **kwargs)

    monkeypatch.setattr(module, "run_result", counted)
    rows = rows_of("single_banana", "full", "no_recovery", "no_memory")
    assert rows["full"]["success"], "a first attempt that succeeds is what the three have in common"
    assert judged == ["full"]
    assert set(rows) == {"full", "no_recovery", "no_memory"}
    assert all(row["goals"] == rows["full"]["goals"] for row in rows.values())
