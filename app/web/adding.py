"""One more object on the table: the scene with it as a file of the user's, from which a new world is opened."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kb.errors import BadInputError, EnvironmentFaultError

if TYPE_CHECKING:
    from tools.open_world import OpenedWorld

MOVED, ON_TABLE, UPRIGHT = 0.002, 0.01, 0.995
"""From where on a thing has moved, and how high and how steep one stands on the table [m, m, cosine]."""
RELATIONS = ("near", "gap", "bearing", "on", "position", "yaw")
"""What an entry says of its place."""


def scene_with(scene: str, model: str, position: tuple[float, float] | None, opened: OpenedWorld | None = None) -> str:
    """Path of a scene file that holds what `scene` holds and one more object of the catalogue.

    Args:
        scene: Built-in name or file.
        model: Name in the catalogue.
        position: Centre of its footprint [m]; drawn with the seed if left out.
        opened: The world of that scene as it stands: with the same seed its things come again as they are, where they are.

    Raises:
        BadInputError: unknown model, or a scene whose objects come from files beside it.
        EnvironmentFaultError: the file cannot be written.
    """
    import yaml

    from agent.checkpoint import default_threads
    from sim.catalogue import MODELS
    from sim.scene_file import load_scene

    if model not in MODELS:
        raise BadInputError(f"there is no model {model!r}", where="add", choices=MODELS)
    spec = load_scene(scene)
    if any(thing.model is None for thing in spec.objects):
        raise BadInputError("this scene has objects of its own files; add to its YAML file instead", where="add")
    taken = {thing.id for thing in spec.objects}
    name = next(f"{model}_{n}" for n in range(1, 100) if f"{model}_{n}" not in taken)
    entry: dict[str, Any] = {"id": name, "model": model}
    if position is not None:
        entry["position"] = list(position)
    tree = spec.model_dump(mode="json", exclude={"source"}, exclude_defaults=True, exclude_none=True)
    tree["like"] = spec.like or spec.name
    if opened is not None:
        tree["objects"] = _as_they_stand(tree["objects"], opened)
        tree["randomise"] = {**tree.get("randomise", {}), "position": 0.0, "yaw": 0.0}
    tree["objects"] = [*tree["objects"], entry]
    if tree.get("task", {}).get("target") not in (None, *(thing["id"] for thing in tree["objects"])):
        del tree["task"]
    tree["name"] = spec.name if spec.name.startswith("my_") else f"my_{spec.name}"[:64]
    folder = default_threads().parent / "scenes"
    path = folder / f"{tree['name']}-{len(tree['objects'])}-{_next(folder)}.yaml"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_text(yaml.safe_dump(tree, sort_keys=False), encoding="utf-8")
    except OSError as error:
        raise EnvironmentFaultError(
            f"cannot write {path}: {error.strerror}", mend="set RAGVLM_HOME to a folder that can be written"
        ) from error
    return str(path)


def _as_they_stand(entries: list[dict[str, Any]], opened: OpenedWorld) -> list[dict[str, Any]]:
    """The entries with the places of now; what lies, hangs or is in the bin goes back to where it stood at first."""
    things, poses = {thing.id: thing for thing in opened.placed.objects}, opened.observer.poses()
    moved = {
        name: pose
        for name, pose in poses.items()
        if name in things and math.dist(pose[:3], things[name].position) > MOVED and _stands(pose)
    }
    named, found = {entry["id"]: entry for entry in entries}, list[dict[str, Any]]()
    for thing in opened.placed.objects:  # some scenes draw which things there are
        entry = named.get(thing.id, {"id": thing.id})
        if thing.fixed:
            found.append(entry)
            continue
        stacked = "on" in entry and not {thing.id, entry["on"]} & moved.keys()
        pose = moved.get(thing.id, (*thing.position, *thing.quaternion))
        kept = {key: value for key, value in entry.items() if key not in RELATIONS}
        place = {"on": entry["on"]} if stacked else {"position": [float(pose[0]), float(pose[1])]}
        yaw = 2.0 * math.atan2(float(pose[6]), float(pose[3]))
        found.append({**kept, "model": thing.model, **place, "yaw": yaw})
    return found


def _stands(pose: Any) -> bool:
    """Whether it stands upright on the table: position and quaternion (7,) of the middle of its footprint."""
    leaning = 1.0 - 2.0 * (float(pose[4]) ** 2 + float(pose[5]) ** 2)
    return abs(float(pose[2])) < ON_TABLE and leaning > UPRIGHT


def _next(folder: Path) -> int:
    """A number that no scene file in the folder has yet: sessions go on using the earlier files."""
    numbers = [int(p.stem.rpartition("-")[2]) for p in folder.glob("*-*.yaml") if p.stem.rpartition("-")[2].isdigit()]
    return max(numbers, default=0) + 1
