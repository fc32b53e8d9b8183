"""JSON schemas that the command line prints: of the tools' arguments and of the run's result."""

from __future__ import annotations

import importlib
import inspect
from typing import Any

from kb.errors import BadInputError

TOOL_NAMES = (
    "perceive",
    "retrieve_haarag",
    "build_scene_graph",
    "infer_constraints",
    "plan_grasp",
    "execute_grasp",
    "classify_failure",
    "correct_grasp",
    "place_object",
    "choose_grasp",
    "confirm_grasp",
    "name_objects",
    "gather_experience",
)
"""The verbs of `tools`, in the order in which a run uses them, then those of language models; a tool's file has its name."""


def tool_schemas() -> dict[str, dict[str, Any]]:
    """Tool name -> description, schema of its arguments and, where it is a model, of its result."""
    return {name: _describe(name) for name in TOOL_NAMES}


def result_schema(name: str) -> dict[str, Any]:
    """The schema of `RunResult`, or the description of one tool.

    Raises:
        BadInputError: there is no such name.
    """
    if name == "RunResult":
        from kb.run_result import RunResult

        return RunResult.model_json_schema()
    if name in TOOL_NAMES:
        return _describe(name)
    raise BadInputError(f'there is no schema "{name}"', where="--schema", choices=("RunResult", *TOOL_NAMES))


def _describe(name: str) -> dict[str, Any]:
    """A tool's first docstring line and the schemas of its argument model and result."""
    from pydantic import BaseModel

    verb = getattr(importlib.import_module(f"tools.{name}"), name)
    hints = inspect.get_annotations(verb)
    row: dict[str, Any] = {"description": (inspect.getdoc(verb) or "").split("\n", 1)[0]}
    for key, hint in (("arguments", next(iter(hints.values()))), ("result", hints["return"])):
        # Annotations are words here, and some name what only type checkers import; arguments and results do not.
        kind = getattr(importlib.import_module(f"tools.{name}"), hint, None) if isinstance(hint, str) else hint
        if inspect.isclass(kind) and issubclass(kind, BaseModel):
            row[key] = kind.model_json_schema()
    return row
