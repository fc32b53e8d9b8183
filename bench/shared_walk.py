"""Walks the agent's own task graph without LangGraph's run time, and shares what several configurations have in common.

The wiring (nodes, edges, branches, reducers) is read from `agent.graph.wire`, so that nothing of the agent is written
twice; what is left out is what a benchmark does not need: checkpoints, channels, threads, and waiting for a person. A
test holds the results of both ways against each other.

Configurations differ in their switches alone. A node is deterministic given the state, the world and the switches that it
reads, so that a configuration that agrees with an earlier one in every switch that was read so far has the very same
beginning: those steps are taken over instead of computed again. The world needs no care, because every node that looks or
moves first puts it where the state says (`agent.world_handle`).
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, get_type_hints

from agent.conversation import STEP_LIMIT, checked
from agent.state import State
from kb.switches import Switches

START, END = "__start__", "__end__"
"""Names that the wiring gives to its two ends."""

Reads = dict[str, Any]
"""Switches that were read, with their values."""


@dataclass(frozen=True)
class Injected:
    """What a node gets beside the state: as much of LangGraph's runtime as the nodes use."""

    context: Any


class WatchedSwitches:
    """Switches that remember which of them were read."""

    def __init__(self, switches: Switches) -> None:
        self._switches = switches
        self.reads: Reads = {}

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._switches, name)
        if name not in Switches.model_fields:
            # Whoever takes the switches as a whole has read them all.
            self.reads.update({known: getattr(self._switches, known) for known in Switches.model_fields})
        else:
            self.reads[name] = value
        return value


@dataclass
class Step:
    """One node that was run: what it read and changed, and where the graph went next."""

    reads: Reads
    update: Any
    goes_to: str
    seconds: float
    """What it took [s]."""
    after: list[Step] = field(default_factory=list["Step"])
    """Steps that followed it, one for each reading of the switches."""


@dataclass(frozen=True)
class Wiring:
    """The task graph as plain functions."""

    start: str
    nodes: dict[str, Callable[..., Any]]
    edges: dict[str, str]
    branches: dict[str, tuple[Callable[..., Any], dict[str, str]]]
    reducers: dict[str, Callable[[Any, Any], Any]]


@lru_cache(maxsize=1)
def wiring() -> Wiring:
    """The agent's graph, taken apart.

    Raises:
        ValueError: the graph has a node with several successors at once; then it can't be walked step by step.
    """
    from agent.graph import wire

    graph: Any = wire()
    edges = {str(begin): str(end) for begin, end in graph.edges}
    branches: dict[str, tuple[Callable[..., Any], dict[str, str]]] = {}
    for name, specs in graph.branches.items():
        for spec in specs.values():
            if name in branches or name in edges:
                raise ValueError(f"the node {name} has several successors at once")
            branches[name] = _callable(spec.path), {str(word): end for word, end in (spec.ends or {}).items()}
    if len(edges) != len(graph.edges):
        raise ValueError("a node has several successors at once")
    hints = get_type_hints(State, include_extras=True)
    reducers = {name: hint.__metadata__[0] for name, hint in hints.items() if hasattr(hint, "__metadata__")}
    nodes = {name: _callable(spec.runnable) for name, spec in graph.nodes.items()}
    return Wiring(edges[START], nodes, edges, branches, reducers)


def _callable(runnable: Any) -> Callable[..., Any]:
    """The function in a runnable, taking state and runtime."""
    function = runnable.func
    if "runtime" in inspect.signature(function).parameters:
        return function
    return lambda state, runtime: function(state)


class SharedWalk:
    """The steps that the configurations of one trial have taken so far."""

    def __init__(self) -> None:
        self._roots: dict[Any, list[Step]] = {}
        self.shared = 0
        """Steps of the last walk that an earlier configuration had taken already."""

    def run(self, context: Any, instruction: str, kind: Any, credit: Callable[[float], None]) -> State:
        """Carries out an instruction from a fresh state and returns the state at the end.

        Args:
            context: What the nodes are injected with (`agent.context.AgentContext`).
            instruction: What the robot is told.
            kind: What else tells configurations apart besides their switches; nothing is shared between kinds.
            credit: Told the seconds that a shared step would have taken.

        Raises:
            RuntimeError: the graph does not come to an end.
        """
        graph, runtime, state = wiring(), Injected(context), State()
        state = _reduced(graph, state, {"instruction": checked(instruction), "times": None})
        real = context.tools.switches
        watched = WatchedSwitches(real)
        context.tools.switches = watched
        known, name, self.shared = self._roots.setdefault(kind, []), graph.start, 0
        try:
            for _ in range(STEP_LIMIT):
                step = next((step for step in known if _agree(step.reads, real)), None)
                if step is None:
                    watched.reads = {}
                    step, state = _take(graph, name, state, runtime, watched)
                    known.append(step)
                else:
                    credit(step.seconds)
                    self.shared += 1
                    state = _reduced(graph, state, step.update)
                if step.goes_to == END:
                    return state
                known, name = step.after, step.goes_to
        finally:
            context.tools.switches = real
        raise RuntimeError(f"the graph did not end within {STEP_LIMIT} steps")


def _agree(reads: Reads, switches: Switches) -> bool:
    return all(getattr(switches, name) == value for name, value in reads.items())


def _take(graph: Wiring, name: str, state: State, runtime: Any, watched: WatchedSwitches) -> tuple[Step, State]:
    """Runs a node and the decision after it; the state is the one after the node."""
    clock = runtime.context.clock
    start = clock()
    update = graph.nodes[name](state, runtime) or {}
    after = _reduced(graph, state, update)
    if name in graph.edges:
        goes_to = graph.edges[name]
    else:
        decide, ends = graph.branches[name]
        word = decide(after, runtime)
        goes_to = ends.get(str(word), str(word))
    return Step(watched.reads, update, goes_to, clock() - start), after


def _reduced(graph: Wiring, state: State, update: Any) -> State:
    """The state with an update, by the reducers of its fields."""
    changed = State.__new__(State)
    vars(changed).update(vars(state))
    for name, value in update.items():
        reducer = graph.reducers.get(name)
        setattr(changed, name, value if reducer is None else reducer(getattr(state, name), value))
    return changed
