"""`ragvlm scenes`: the built-in scenes, or what one scene holds."""

from __future__ import annotations

from typing import Annotated, Optional

import typer


def scenes(
    name: Annotated[
        Optional[str],  # noqa: UP045
        typer.Argument(metavar="[NAME|FILE]", help="A scene to look into; all built-in ones if left out."),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, metavar="N", help="Seed of the scene's random part.")] = 0,
) -> None:
    """List the built-in scenes, or show what one scene (or your own YAML file) holds."""
    from app.console import make_console

    console = make_console()
    if name is None:
        _list(console)
    else:
        _describe(console, name, seed)


def _list(console) -> None:
    from app.table import print_table
    from sim.draw_scene import draw_scene
    from sim.scene_file import builtin_scenes, load_scene

    rows = []
    for name in builtin_scenes():
        placed = draw_scene(load_scene(name), 0)
        task = placed.task
        say = task.instructions[0] if task and task.instructions else ""
        rows.append((name, ", ".join(thing.category for thing in placed.objects), say))
    print_table(console, ("scene", "holds (seed 0)", "say for example"), rows)


def _describe(console, name: str, seed: int) -> None:
    from app.table import print_table
    from sim.draw_scene import draw_scene
    from sim.scene_file import load_scene

    placed = draw_scene(load_scene(name), seed)
    rows = [
        (
            thing.id,
            thing.model,
            thing.category,
            thing.state,
            f"({thing.position[0]:.3f}, {thing.position[1]:.3f}, {thing.position[2]:.3f})",
            " x ".join(f"{side * 1000:.0f}" for side in thing.size),
            f"{thing.mass * 1000:.0f}",
            f"{thing.affordance.fragility:.2f}",
        )
        for thing in placed.objects
    ]
    console.print(f"{placed.name}, seed {seed} (the truth; perception from pixels sees none of these numbers)")
    print_table(console, ("id", "model", "category", "state", "position m", "size mm", "mass g", "fragility"), rows)
    if placed.task:
        for sentence in placed.task.instructions:
            console.print(f'  try: ragvlm run "{sentence}" --scene {name} --seed {seed}')
