"""The agent: language, task graph, retry ladder. `build_agent` is its door; everything heavy loads when it is built."""

from agent.build_agent import build_agent
from agent.conversation import Agent

__all__ = ["Agent", "build_agent"]
