"""What importing and building costs: nothing heavy before it is needed."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import sys
{code}
heavy = {{"torch", "transformers", "chromadb", "scipy", "matplotlib", "trimesh", "langchain_openai"}}
print(",".join(sorted(heavy & set(sys.modules))))
print(any(m.startswith("langgraph") for m in sys.modules), "mujoco" in sys.modules)
"""


def loaded(code: str) -> list[str]:
    """The two lines that the script prints after running `code` in a fresh interpreter."""
    out = subprocess.run([sys.executable, "-c", SCRIPT.format(code=code)], capture_output=True, text=True, check=True)
    return out.stdout.splitlines()


def test_importing_the_agent_is_light() -> None:
    """`import agent` loads neither LangGraph nor MuJoCo nor anything heavy."""
    assert loaded("import agent") == ["", "False False"]


@pytest.mark.slow
def test_a_run_needs_nothing_heavy() -> None:
    """A whole run with the rules brain loads no torch, transformers, scipy, matplotlib or trimesh."""
    code = 'from agent import build_agent\nbuild_agent("single_cube").run("pick up the cube")'
    heavy, light = loaded(code)
    assert heavy in ("", "chromadb")  # the store of experiences may use its database
    assert light == "True True"
