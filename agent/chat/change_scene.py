"""Another scene in the same conversation: what was said and learnt stays, the table is a new one."""

from __future__ import annotations

import dataclasses
from typing import Any

from agent.state import Update
from agent.world_handle import WatchedRobot, WorldHandle


def enter(context: Any, scene: str, seed: int, perception: str) -> None:
    """Opens the scene and puts the agent in it; a stop that was pressed stays pressed.

    Args:
        context: `agent.context.AgentContext`, changed in place.
        scene: Built-in name or file.
        seed: Everything random in the world follows from it.
        perception: Name of the perception.

    Raises:
        BadInputError: the scene cannot be used; the old one stays as it is then.
    """
    from tools.open_world import open_perceiver, open_world

    old = context.world.opened
    opened = open_world(scene, seed, evaluator=old.evaluator, noise=old.placed.noise)
    if old.stop.pressed:
        opened.stop.press()
    context.tools = dataclasses.replace(
        context.tools,
        robot=WatchedRobot(opened.robot),
        perceiver=open_perceiver(perception, opened, context.tools.embedder),  # pyright: ignore[reportArgumentType]
        stop=opened.stop,
    )
    context.world, context.scene, context.seed = WorldHandle(opened), scene, seed


def emptied(scene: str, seed: int) -> Update:
    """The state's update: nothing of the old table is there any more."""
    return Update(
        scene=scene, seed=seed, goals=(), agenda=(), percept=None, before=None, stale=True, pictures=(), experiences=None,
        shown=None, graph=None, plan=None, held=None, last_target=None, world=b"", moved=None, displaced=(), in_bin=(),
        motions={}, pending=None, asked=(), deed=(), demands=(), call=None, calls=(), executed=False, refused=False, answer="", question=None,
    )  # fmt: skip
