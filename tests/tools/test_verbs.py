"""The verbs of the tools room, as a person imports them."""

import inspect

import pytest

import tools


@pytest.mark.parametrize("name", tools.__all__)
def test_a_tool_imported_from_the_room_is_its_function(name: str) -> None:
    """`from tools import execute_grasp` gives the function, not the file of that name; it takes arguments and context."""
    verb = getattr(tools, name)
    assert inspect.isfunction(verb)
    assert verb.__module__ == f"tools.{name}"
    assert list(inspect.signature(verb).parameters)[:2] == ["args", "context"]
