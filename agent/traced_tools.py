"""The tools as the nodes call them: the same functions, and a run of each is told to whoever traces the graph."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from langchain_core.callbacks import CallbackManager
from langchain_core.runnables.config import var_child_runnable_config

from tools.build_scene_graph import build_scene_graph as _build_scene_graph
from tools.choose_grasp import choose_grasp as _choose_grasp
from tools.classify_failure import classify_failure as _classify_failure
from tools.correct_grasp import correct_grasp as _correct_grasp
from tools.execute_grasp import execute_grasp as _execute_grasp
from tools.infer_constraints import infer_constraints as _infer_constraints
from tools.name_objects import name_objects as _name_objects
from tools.perceive import perceive as _perceive
from tools.place_object import place_object as _place_object
from tools.plan_grasp import plan_grasp as _plan_grasp
from tools.retrieve_haarag import retrieve_haarag as _retrieve_haarag

P = ParamSpec("P")
R = TypeVar("R")


def traced(tool: Callable[P, R]) -> Callable[P, R]:
    """The tool, told to the callbacks of the node it is called in (none outside of a graph)."""

    @functools.wraps(tool)
    def called(*args: P.args, **kwargs: P.kwargs) -> R:
        config = var_child_runnable_config.get()
        callbacks: Any = config.get("callbacks") if config else None
        handlers = getattr(callbacks, "handlers", None) or []
        if not handlers:
            return tool(*args, **kwargs)
        manager = CallbackManager(handlers, parent_run_id=getattr(callbacks, "parent_run_id", None))
        run = manager.on_tool_start({"name": getattr(tool, "__name__", "tool")}, _given(args))
        try:
            result = tool(*args, **kwargs)
        except BaseException as error:
            run.on_tool_error(error)
            raise
        run.on_tool_end(type(result).__name__ if not hasattr(result, "reason") else str(getattr(result, "reason", "")))
        return result

    return called


def _given(args: tuple[Any, ...]) -> str:
    """The arguments that tell what the call is about."""
    given = args[0] if args else None
    told = {
        name: getattr(given, name)
        for name in ("target", "category", "look", "attempt", "failure", "level")
        if hasattr(given, name)
    }
    return ", ".join(f"{name}={getattr(value, 'id', value)}" for name, value in told.items())


build_scene_graph = traced(_build_scene_graph)
choose_grasp = traced(_choose_grasp)
classify_failure = traced(_classify_failure)
correct_grasp = traced(_correct_grasp)
execute_grasp = traced(_execute_grasp)
infer_constraints = traced(_infer_constraints)
name_objects = traced(_name_objects)
perceive = traced(_perceive)
place_object = traced(_place_object)
plan_grasp = traced(_plan_grasp)
retrieve_haarag = traced(_retrieve_haarag)
