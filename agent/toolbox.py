"""The tools as LangChain tools, made from the very functions and argument models that nodes and tests call."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from langchain_core.tools import StructuredTool
from pydantic import BaseModel

from kb.errors import BadInputError
from tools.context import ToolContext

TOOLS: dict[str, str] = {
    "perceive": "PerceiveArgs",
    "retrieve_haarag": "RetrieveArgs",
    "build_scene_graph": "SceneGraphArgs",
    "infer_constraints": "ConstraintArgs",
    "plan_grasp": "PlanArgs",
    "execute_grasp": "ExecuteArgs",
    "classify_failure": "ClassifyArgs",
    "correct_grasp": "CorrectArgs",
    "place_object": "PlaceArgs",
    "choose_grasp": "ChooseArgs",
    "confirm_grasp": "ConfirmArgs",
    "name_objects": "NameArgs",
    "gather_experience": "GatherArgs",
}
"""Tool (and file) name -> name of its argument model."""


@dataclass(frozen=True)
class Tool:
    """One verb with its argument model."""

    name: str
    args: type[BaseModel]
    verb: Callable[[Any, Any], BaseModel]

    @property
    def summary(self) -> str:
        """First paragraph of the verb's docstring."""
        return " ".join((self.verb.__doc__ or self.name).split("\n\n")[0].split())

    def schema(self) -> dict[str, Any]:
        """JSON schema of the arguments."""
        return self.args.model_json_schema()


def tool_named(name: str) -> Tool:
    """The tool of that name.

    Raises:
        BadInputError: unknown name.
    """
    if name not in TOOLS:
        raise BadInputError(f"unknown tool {name!r}", choices=TOOLS)
    module = importlib.import_module(f"tools.{name}")
    return Tool(name, getattr(module, TOOLS[name]), getattr(module, name))


def as_langchain(name: str, context: ToolContext) -> StructuredTool:
    """The tool bound to a context, for any language model that calls tools.

    The model gives the fields of the argument model; the result is the verb's own value, its JSON the content.
    """
    tool = tool_named(name)

    def call(**fields: Any) -> tuple[str, BaseModel]:
        args = tool.args.model_validate({key: _plain(value) for key, value in fields.items()})
        result = tool.verb(args, context)
        return result.model_dump_json(), result

    return StructuredTool.from_function(
        func=call, name=name, description=tool.summary, args_schema=tool.args, response_format="content_and_artifact"
    )


def toolbox(context: ToolContext) -> list[StructuredTool]:
    """All tools bound to a context."""
    return [as_langchain(name, context) for name in TOOLS]


def _plain(value: Any) -> Any:
    """Models that LangChain has validated already go through their data again, so that one path serves both ways."""
    return value.model_dump() if isinstance(value, BaseModel) else value
