"""One more object on the table: the scene with it as a file of the user's, from which a new world is opened."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from kb.errors import BadInputError, EnvironmentFaultError


def scene_with(scene: str, model: str, position: tuple[float, float] | None) -> str:
    """Path of a scene file that holds what `scene` holds and one more object of the catalogue.

    Args:
        scene: Built-in name or file.
        model: Name in the catalogue.
        position: Centre of its footprint [m]; drawn with the seed if left out.

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
    tree["objects"] = [*tree["objects"], entry]
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


def _next(folder: Path) -> int:
    """A number that no scene file in the folder has yet: sessions go on using the earlier files."""
    numbers = [int(p.stem.rpartition("-")[2]) for p in folder.glob("*-*.yaml") if p.stem.rpartition("-")[2].isdigit()]
    return max(numbers, default=0) + 1
