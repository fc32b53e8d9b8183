"""Reads scene files: every defect gives one error with the file, the line and the object's name, and changes nothing."""

from __future__ import annotations

from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from kb.errors import BadInputError
from sim.ood_catalogue import ALL_MODELS, any_model
from sim.own_object import check_files
from sim.scene_spec import ObjectSpec, Randomise, SceneSpec, Source, TaskSpec
from sim.tasks.clutter import PREFIX, clutter_scene, clutter_scenes
from sim.tasks.ood import ood_scene, ood_scenes

MAX_BYTES = 1_000_000
"""Largest scene file [bytes]; a scene of forty objects has a few thousand."""
MAX_DEPTH = 12
"""Deepest nesting in a scene file; the format needs five."""
MAX_VALUES = 20_000
"""Most values in a scene file, aliases expanded."""
SUFFIXES = (".yaml", ".yml")

Lines = dict[tuple[str | int, ...], int]


def builtin_scenes() -> tuple[str, ...]:
    """Names of the built-in scenes, one a task, sorted."""
    folder = resources.files("sim").joinpath("scenes")
    return tuple(sorted(entry.name[:-5] for entry in folder.iterdir() if entry.name.endswith(".yaml")))


def load_scene(name_or_path: str) -> SceneSpec:
    """The scene of a built-in name or of a YAML file.

    Raises:
        BadInputError: the scene is unknown, or its file is unreadable or wrong.
    """
    if name_or_path in builtin_scenes():
        return _builtin(name_or_path)
    if name_or_path in clutter_scenes():
        return clutter_scene(name_or_path.removeprefix(PREFIX))
    if name_or_path in ood_scenes():
        return ood_scene(name_or_path)
    looks_like_file = name_or_path.lower().endswith(SUFFIXES) or "/" in name_or_path
    path = Path(name_or_path)
    if not looks_like_file and not path.is_file():
        raise BadInputError(
            f"there is no scene {name_or_path!r}", choices=(*builtin_scenes(), "a path that ends in .yaml")
        )
    return _parse(_read(path), str(path), str(path))


@lru_cache(maxsize=64)
def _builtin(name: str) -> SceneSpec:
    """A built-in scene, parsed once: a benchmark opens each of them hundreds of times."""
    text = resources.files("sim").joinpath("scenes", f"{name}.yaml").read_text(encoding="utf-8")
    return _parse(text, name, None)


def _read(path: Path) -> str:
    where = str(path)
    try:
        if not path.is_file():
            raise BadInputError("there is no such scene file", where=where)
        if path.stat().st_size > MAX_BYTES:
            raise BadInputError(f"a scene file has at most {MAX_BYTES} bytes", where=where)
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise BadInputError("it is not UTF-8 text", where=where) from error
    except OSError as error:
        raise BadInputError(f"it cannot be read: {error.strerror}", where=where) from error


def _parse(text: str, where: str, file: str | None) -> SceneSpec:
    tree, lines = _tree(text, where)
    if not isinstance(tree, dict):
        raise BadInputError("a scene file is a mapping with name and objects", where=f"{where}:1")
    if "source" in tree:
        raise BadInputError("unknown key 'source'", where=f"{where}:{lines['source',]}", choices=_keys(SceneSpec))
    ids = _ids(tree)
    located = {name: lines[("objects", index)] for index, name in enumerate(ids) if name is not None}
    try:
        spec = SceneSpec.model_validate({**tree, "source": Source(file=file, lines=located)})
    except ValidationError as error:
        raise _readable(error, where, lines, ids) from error
    _check_references(spec)
    return spec


def _ids(tree: dict[str, Any]) -> list[str | None]:
    """Ids of the entries under `objects` where they are strings."""
    entries = tree.get("objects")
    if not isinstance(entries, list):
        return []
    names = [entry.get("id") if isinstance(entry, dict) else None for entry in entries]
    return [name if isinstance(name, str) else None for name in names]


def _tree(text: str, where: str) -> tuple[Any, Lines]:
    """Plain values of a YAML document and the line of each of them."""
    lines: Lines = {}
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
        if root is None:
            raise BadInputError("the file is empty", where=f"{where}:1")
        loader = yaml.SafeLoader("")
        return _value(root, (), lines, loader, where), lines
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = "" if mark is None else f":{mark.line + 1}"
        problem = getattr(error, "problem", None) or str(error)
        began = getattr(error, "context_mark", None)
        if mark is not None and began is not None and began.line != mark.line:
            inside = getattr(error, "context", None) or "it"
            problem += f" ({inside}, begun in line {began.line + 1})"
        raise BadInputError(f"malformed YAML: {problem}", where=f"{where}{line}") from error
    except RecursionError as error:
        raise BadInputError("it is nested too deeply", where=where) from error
    except ValueError as error:
        raise BadInputError(f"malformed YAML: {error}", where=where) from error


def _value(node: Any, path: tuple[str | int, ...], lines: Lines, loader: yaml.SafeLoader, where: str) -> Any:
    line = node.start_mark.line + 1
    if len(path) > MAX_DEPTH or len(lines) > MAX_VALUES:
        raise BadInputError("it has too many or too deeply nested values", where=f"{where}:{line}")
    lines[path] = line
    if isinstance(node, yaml.ScalarNode):
        try:
            return loader.construct_object(node)
        except (ValueError, OverflowError) as error:
            raise BadInputError(f"malformed YAML: {node.value!r} is not a value", where=f"{where}:{line}") from error
    if isinstance(node, yaml.SequenceNode):
        return [_value(child, (*path, index), lines, loader, where) for index, child in enumerate(node.value)]
    result: dict[str, Any] = {}
    for key_node, value_node in node.value:
        key = key_node.value if isinstance(key_node, yaml.ScalarNode) else "?"
        key_line = key_node.start_mark.line + 1
        if key in result:
            raise BadInputError(f"the key {key!r} stands twice", where=f"{where}:{key_line}")
        result[key] = _value(value_node, (*path, key), lines, loader, where)
        lines[(*path, key)] = key_line
    return result


def _keys(noun: Any) -> tuple[str, ...]:
    return tuple(key for key in noun.model_fields if key != "source")


def _readable(error: ValidationError, where: str, lines: Lines, ids: list[str | None]) -> BadInputError:
    """The first defect, with the line of the key it concerns and the object's name."""
    defect = error.errors()[0]
    location: tuple[str | int, ...] = tuple(defect["loc"])
    known = location
    while known and known not in lines:
        known = known[:-1]
    line = lines.get(known, 1)
    place = f"{where}:{line}"
    noun: Any = SceneSpec
    if len(location) >= 2 and location[0] == "objects" and isinstance(location[1], int):
        index = location[1]
        name = ids[index] if index < len(ids) and ids[index] else f"number {index + 1}"
        place += f": object {name!r}" if index < len(ids) and ids[index] else f": object {name}"
        noun = ObjectSpec
    elif location and location[0] == "task":
        noun = TaskSpec
    elif location and location[0] == "randomise":
        noun = Randomise
    last = location[len(location) - 1] if location else ""
    key = next((str(part) for part in reversed(known) if isinstance(part, str)), "")
    if defect["type"] == "extra_forbidden":
        return BadInputError(f"unknown key {last!r}", where=place, choices=_keys(noun))
    if defect["type"] == "missing":
        return BadInputError(f"the key {last!r} is missing", where=place)
    if noun is Randomise and key != "randomise":
        key = f"randomise: {key}"
    return BadInputError(f"{key}: {_defect_words(defect)}", where=place)


def _defect_words(defect: Any) -> str:
    """What is wrong with a value, without the words of the programming language."""
    kind, facts = str(defect["type"]), defect.get("ctx", {})
    if kind in ("too_short", "too_long"):
        few, bound = ("at least", facts["min_length"]) if kind == "too_short" else ("at most", facts["max_length"])
        return f"it has {facts['actual_length']} entries, {few} {bound} are wanted"
    if kind in ("tuple_type", "list_type"):
        return "a list is wanted"
    if kind in ("model_type", "dict_type", "model_attributes_type"):
        return "a mapping of keys to values is wanted"
    message = str(defect["msg"]).removeprefix("Value error, ")
    return f"{message[:1].lower()}{message[1:]}"


def _check_references(spec: SceneSpec) -> None:
    """Names of models, states and other objects must exist; relations must not run in circles."""
    ids: set[str] = set()
    for thing in spec.objects:
        where = spec.where(thing.id)
        if thing.id in ids:
            raise BadInputError("its id stands twice", where=where)
        ids.add(thing.id)
        if thing.model is not None:
            if thing.model not in ALL_MODELS:
                raise BadInputError(f"there is no model {thing.model!r}", where=where, choices=ALL_MODELS)
            if thing.state == "filled" and any_model(thing.model).form().cavity is None:
                hollow = [name for name, entry in ALL_MODELS.items() if entry.form().cavity is not None]
                raise BadInputError(f"{thing.model!r} cannot be filled", where=where, choices=hollow)
        else:
            if thing.state == "filled":
                raise BadInputError("only catalogue containers can be filled", where=where)
            check_files(thing, spec)
    for thing in spec.objects:
        for other in (thing.near, thing.on):
            if other is not None and (other not in ids or other == thing.id):
                choices = sorted(ids - {thing.id})
                raise BadInputError(f"there is no other object {other!r}", where=spec.where(thing.id), choices=choices)
    bins = [thing for thing in spec.objects if thing.model == "bin"]
    for thing in bins:
        if thing is not bins[0]:
            raise BadInputError("there is one bin only", where=spec.where(thing.id))
        if thing.position or thing.near or thing.on:
            raise BadInputError("the bin has its own stand and takes no place", where=spec.where(thing.id))
    for thing in spec.objects:
        if bins and bins[0].id in (thing.near, thing.on):
            raise BadInputError("nothing can start near or in the bin", where=spec.where(thing.id))
    placement_order(spec)
    _check_task(spec, ids)


def _check_task(spec: SceneSpec, ids: set[str]) -> None:
    if spec.task is None:
        return
    named = [spec.task.target, spec.task.side_grasp_of, *(entry.target for entry in spec.task.required)]
    for name in named:
        if name is not None and name not in ids:
            raise BadInputError(f"task: there is no object {name!r}", where=spec.where(), choices=sorted(ids))


def placement_order(spec: SceneSpec) -> tuple[ObjectSpec, ...]:
    """The objects so that each comes after the one it stands near or on; otherwise in the file's order.

    Raises:
        BadInputError: relations run in a circle.
    """
    waiting = list(spec.objects)
    ordered: list[ObjectSpec] = []
    done: set[str] = set()
    while waiting:
        ready = next((thing for thing in waiting if {thing.near, thing.on} - {None} <= done), None)
        if ready is None:
            raise BadInputError("near and on run in a circle", where=spec.where(waiting[0].id))
        waiting.remove(ready)
        ordered.append(ready)
        done.add(ready.id)
    return tuple(ordered)
