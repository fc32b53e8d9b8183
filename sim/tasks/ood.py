"""The scenes of the out-of-distribution suite: one object alone on the table, known, near or far (benchmark.md section 6).

A scene is named `ood_<model>`. The dinner plate lies on its stand, because fingers must get under its rim.
"""

from __future__ import annotations

from kb.errors import BadInputError
from sim.catalogue import TABLE_I
from sim.ood_catalogue import FAR, NEAR, STAND, any_model
from sim.scene_spec import ObjectSpec, Randomise, SceneSpec, TaskSpec

PREFIX = "ood_"
SENTENCES = ("pick up the {}", "grab the {}", "lift the {} off the table", "please take the {}", "get me the {}")
WORDS: dict[str, str] = {
    "wine_glass": "wine glass",
    "wood_cube": "wooden cube",
    "tennis_ball": "tennis ball",
    "toy_block": "toy block",
    "foam_ball": "ball",
    "soup_can": "can",
    "spice_jar": "jar",
    "watering_can": "watering can",
    "dinner_plate": "plate",
    "light_bulb": "bulb",
    "kitchen_knife": "knife",
    "hairbrush": "brush",
    "tv_remote": "remote",
    "paperback": "book",
    "clothes_peg": "peg",
    "plush_toy": "plush",
}
"""Model -> what a person calls it; otherwise its category."""
SPREAD = Randomise(yaw=3.1416, size=0.05, mass=0.2, friction=0.2)


def ood_groups() -> dict[str, tuple[str, ...]]:
    """Scene names by group: "in_dist" (Table I), "near" and "far"."""
    groups = {"in_dist": TABLE_I, "near": tuple(NEAR), "far": tuple(FAR)}
    return {group: tuple(PREFIX + name for name in names) for group, names in groups.items()}


def ood_scenes() -> tuple[str, ...]:
    """Names of all scenes."""
    return tuple(name for names in ood_groups().values() for name in names)


def ood_scene(name: str) -> SceneSpec:
    """The scene of that name.

    Raises:
        BadInputError: there is no such scene.
    """
    if name not in ood_scenes():
        raise BadInputError(f"there is no scene {name!r}", choices=ood_scenes())
    model = name.removeprefix(PREFIX)
    word = WORDS.get(model, any_model(model).category.replace("_", " "))
    objects = (ObjectSpec(id=model, model=model),)
    if model == "dinner_plate":
        objects = (ObjectSpec(id=STAND.name, model=STAND.name), ObjectSpec(id=model, model=model, on=STAND.name))
    return SceneSpec(
        name=name,
        objects=objects,
        randomise=SPREAD,
        separation=0.08,
        task=TaskSpec(target=model, instructions=tuple(sentence.format(word) for sentence in SENTENCES)),
    )
