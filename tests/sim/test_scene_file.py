"""Scene files: what is accepted, and the one-line errors of what is not."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kb.errors import BadInputError
from sim.catalogue import MODELS
from sim.draw_scene import draw_scene
from sim.scene_file import builtin_scenes, load_scene, placement_order

GOOD = """
name: my_table
objects:
  - {id: cup, model: ceramic_cup, position: [0.50, 0.05], yaw: 0.4, state: filled}
  - {id: glass, model: wine_glass, near: cup, gap: 0.05, bearing: 1.57}
  - {id: bowl, model: ceramic_bowl, position: [0.6, -0.2]}
  - {id: block, model: toy_block, on: bowl, scale: 1.6}
randomise: {position: 0.0, yaw: 0.0, size: 0.0, mass: 0.2, friction: 0.2}
"""


def write(folder: Path, text: str) -> str:
    path = folder / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def entry(text: str) -> str:
    return f"name: t\nobjects:\n  - {text}\n"


def test_the_documented_example_loads(tmp_path: Path) -> None:
    """The example of the documentation is read as it says."""
    spec = load_scene(write(tmp_path, GOOD))
    assert [thing.id for thing in spec.objects] == ["cup", "glass", "bowl", "block"]
    assert spec.entry("glass").gap == 0.05
    assert spec.randomise.mass == 0.2
    assert not spec.builtin


def test_built_in_scenes_are_the_sixteen_tasks() -> None:
    """There is one built-in scene a task: twelve of the paper and four supplementary ones."""
    assert set(builtin_scenes()) == {
        *(f"single_{thing}" for thing in ("cup", "apple", "bottle", "banana", "bowl", "cube")),
        *("cup_near_vase", "ball_behind_box", "phone_near_wine_glass", "screwdriver_side_grasp"),
        *("clear_table", "sort_by_fragility"),
        *("filled_cup", "block_on_bowl", "repeated_categories", "phone_between_glasses"),
    }


@pytest.mark.parametrize("name", builtin_scenes())
def test_built_in_tasks_are_complete(name: str) -> None:
    """Every built-in scene has a task with at least five different instructions and a target or a table-wide goal."""
    task = load_scene(name).task
    assert task is not None
    assert len(set(task.instructions)) >= 5
    assert (task.target is None) == (task.kind != "pick")


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("", 1, "empty"),
        ("[1, 2]", 1, "mapping"),
        ("name: t\nobjects: [", 2, "malformed YAML"),
        ("name: t\nobjects:\n  - {id: a, model: apple}\n  bad", 4, "malformed YAML"),
        ("name: t\nobjects:\n  - {id: a, model: apple}\ncolour: 3\n", 4, "unknown key 'colour'"),
        ("name: t\n", 1, "'objects' is missing"),
        ("name: t\nobjects: []\n", 2, "objects: it has 0 entries, at least 1 are wanted"),
        ("name: t\nobjects:\n  - {id: a, model: apple\n  - x\n", 5, "begun in line 3"),
        ("name: t\nobjects: 3\n", 2, "objects: a list is wanted"),
        ("name: t\nobjects: [3]\n", 2, "objects: a mapping of keys to values is wanted"),
        (entry("{id: a, model: apple}\nrandomise: {wobble: 1}"), 4, "valid: position, yaw, size, mass, friction)"),
        (entry("{id: a, model: apple}\nrandomise: {position: -1}"), 4, "randomise: position: input should be"),
        (entry("{id: a, model: apple, position: here}"), 3, "position: a list is wanted"),
        (entry("{model: apple}"), 3, "'id' is missing"),
        (entry("{id: a, model: apple, colr: red}"), 3, "unknown key 'colr'"),
        (entry("{id: a, model: samovar}"), 3, "no model 'samovar'"),
        (entry("{id: a}"), 3, "exactly one of model, mesh and mjcf"),
        (entry("{id: a, model: apple, mesh: x.obj}"), 3, "exactly one of model, mesh and mjcf"),
        (entry("{id: a, model: apple, mass: 0}"), 3, "greater than 0"),
        (entry("{id: a, model: apple, mass: -1}"), 3, "greater than 0"),
        (entry("{id: a, model: apple, mass: .nan}"), 3, "finite"),
        (entry("{id: a, model: apple, friction: 0}"), 3, "greater than 0"),
        (entry("{id: a, model: apple, state: full}"), 3, "'empty' or 'filled'"),
        (entry("{id: a, model: apple, state: filled}"), 3, "cannot be filled"),
        (entry("{id: a, model: apple, position: [0.5]}"), 3, "position"),
        (entry("{id: a, model: apple, position: [0.5, 0, -0.1]}"), 3, "height above the table"),
        (entry("{id: a, model: apple, gap: 0.1}"), 3, "need near"),
        (entry("{id: a, model: apple, near: b}"), 3, "no other object 'b'"),
        (entry("{id: a, model: apple, near: a}"), 3, "no other object 'a'"),
        (entry("{id: robot, model: apple}"), 3, "reserved"),
        (entry("{id: 'a b', model: apple}"), 3, "id"),
        (entry("{id: a, model: apple}\n  - {id: a, model: apple}"), 4, "stands twice"),
        (entry("{id: a, model: apple, on: b}\n  - {id: b, model: apple, near: a}"), 3, "circle"),
        (entry("{id: a, id: b, model: apple}"), 3, "stands twice"),
        (entry("{id: a, model: bin, position: [0.5, 0]}"), 3, "own stand"),
        (entry("{id: a, model: bin}\n  - {id: b, model: bin}"), 4, "one bin"),
        (entry("{id: a, model: bin}\n  - {id: b, model: apple, on: a}"), 4, "in the bin"),
        (entry("{id: a, model: apple}\nsource: {file: /etc/passwd}"), 4, "unknown key 'source'"),
        (entry("{id: a, model: apple}\ntask: {target: z, instructions: [go]}"), None, "no object 'z'"),
    ],
)
def test_bad_files_are_refused_with_file_line_and_reason(
    tmp_path: Path, text: str, line: int | None, says: str
) -> None:
    """Each defect gives one line with the file, the line of the defect and what is wrong; nothing is written."""
    path = write(tmp_path, text)
    with pytest.raises(BadInputError) as caught:
        load_scene(path)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(path if line is None else f"{path}:{line}")
    assert says in message
    assert [item.name for item in tmp_path.iterdir()] == ["scene.yaml"]


@pytest.mark.parametrize(
    ("text", "name", "says"),
    [
        (entry("{id: a, model: apple, position: [0.9, 0]}"), "'a'", "hangs off the table"),
        (entry("{id: a, model: apple, position: [0.26, 0]}"), "'a'", "hangs off the table"),
        (entry("{id: a, model: apple, position: [0.8, 0.35]}"), "'a'", "out of reach"),
        (
            entry("{id: a, model: apple, position: [0.5, 0]}\n  - {id: b, model: box, position: [0.55, 0]}"),
            "'b'",
            "overlaps 'a'",
        ),
        (entry("{id: a, model: tennis_ball, position: [0.5, 0]}\n  - {id: b, model: banana, on: a}"), "'b'", "stay"),
    ],
)
def test_impossible_places_are_refused_by_name(tmp_path: Path, text: str, name: str, says: str) -> None:
    """Objects that overlap, hang off, are out of reach or roll off what they lie on are refused with line and name."""
    path = write(tmp_path, text)
    with pytest.raises(BadInputError) as caught:
        draw_scene(load_scene(path), 0)
    message = str(caught.value)
    assert message.startswith(f"{path}:")
    assert name in message
    assert says in message


def test_a_thing_may_stand_in_another_ones_hollow_outline(tmp_path: Path) -> None:
    """Convex outlines may overlap where the things themselves do not: a key in the bend of a banana is accepted."""
    text = entry("{id: a, model: banana, position: [0.5, 0]}\n  - {id: b, model: toy_block, position: [0.5, -0.052]}")
    placed = draw_scene(load_scene(write(tmp_path, text)), 0)
    assert len(placed.objects) == 2


def test_unknown_scene_lists_the_built_in_ones() -> None:
    """An unknown name is refused with the built-in names; a missing file is refused as such."""
    with pytest.raises(BadInputError, match="cup_near_vase"):
        load_scene("cup_near_vas")
    with pytest.raises(BadInputError, match="no such scene file"):
        load_scene("missing.yaml")


def test_alias_bombs_are_refused(tmp_path: Path) -> None:
    """Exponentially growing aliases and self-reference end in an error, not in memory."""
    bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
        f"{b}: &{b} [*{a}, *{a}, *{a}, *{a}, *{a}, *{a}, *{a}, *{a}, *{a}]\n"
        for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    for text in (bomb, "a: &a [*a]\n"):
        with pytest.raises(BadInputError):
            load_scene(write(tmp_path, text))


def test_order_of_placement_follows_dependence() -> None:
    """Things come after what they stand near or on, whatever the file's order."""
    spec = load_scene("cup_near_vase")
    turned = spec.model_copy(update={"objects": spec.objects[::-1]})
    assert [thing.id for thing in placement_order(turned)] == ["cup", "vase"]


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.recursive(
        st.one_of(st.none(), st.booleans(), st.integers(-9, 9), st.floats(), st.text(max_size=8)),
        lambda inner: st.one_of(
            st.lists(inner, max_size=3), st.dictionaries(st.sampled_from(["id", "model", "position", "x"]), inner)
        ),
        max_leaves=8,
    )
)
def test_any_yaml_is_a_scene_or_bad_input(tmp_path: Path, value: object) -> None:
    """Whatever stands under `objects`, loading gives a scene or BadInputError, never another exception."""
    import yaml

    path = write(tmp_path, yaml.safe_dump({"name": "t", "objects": value}))
    message = ""
    try:
        load_scene(path)
    except BadInputError as error:
        message = str(error)
    assert message == "" or message.startswith(path)


def test_every_catalogue_model_can_be_named(tmp_path: Path) -> None:
    """Each catalogue name makes a scene of its own."""
    for name in MODELS:
        text = f"name: t\nobjects:\n  - {{id: thing, model: {name}}}\n"
        placed = draw_scene(load_scene(write(tmp_path, text)), 0)
        assert placed.objects[0].model == name
