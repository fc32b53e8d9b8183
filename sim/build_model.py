"""From a placed scene to a compiled MuJoCo model, with the settings on which verdicts rest.

Everything that moves is a free body under gravity; nothing is welded, glued or held in place. Contact parameters belong
to materials, never to who grasps. Scenes that start in penetration are refused.
"""

# MuJoCo ships no type stubs for its compiled functions.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

import mujoco
import numpy as np

from kb.errors import BadInputError
from sim.panda import panda_actuators, panda_assets, panda_body, panda_defaults, panda_sensors
from sim.placed import Geom, Particles, PlacedObject, PlacedScene

TIMESTEP = 0.002
"""[s]"""
IMPRATIO = 100.0
"""Ratio of friction to normal impedance: at most 0.033 mm/s creep in the hand on every object (10 lets it sag)."""
SOLREF_HARD, SOLREF_SOFT = 0.004, 0.010
"""Contact time constants [s]; damage thresholds hold only for these fixed values and the fixed closing speed."""
SOLIMP = "0.95 0.99 0.001"
TORSION, ROLLING = 0.004, 0.0004
"""Torsional and rolling friction lengths of objects [m]."""
TABLE_CENTRE, TABLE_HALF = (0.55, 0.0, -0.02), (0.30, 0.40, 0.02)
"""Table [m]: 0.6 x 0.8 m, top at z = 0 (ledger G40)."""
FLOOR_Z = -0.75
"""Height of the floor [m]."""
PENETRATION = 5e-4
"""Overlap at the start that is refused [m]; resting contact is a few micrometres deep."""
PARTICLE_FRICTION = 0.4

GEOM_BITS = {
    "object": 'contype="1" conaffinity="3"',
    "setting": 'contype="4" conaffinity="3"',
}
"""Collision bits: objects meet objects, robot and setting; the setting (table, floor, bin) meets objects and robot."""


def build_model(placed: PlacedScene, *, visual: bool = False, check: bool = True) -> mujoco.MjModel:
    """Compiles the scene.

    Args:
        placed: The scene after its random draws.
        visual: Adds the robot's visual meshes, for pictures only; physics is compiled without them.
        check: Refuses scenes that start in penetration.

    Raises:
        BadInputError: an object is malformed, or two things start inside each other.
    """
    text = scene_xml(placed, visual=visual)
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        raise BadInputError(f"the scene does not compile: {error}", where=placed.name) from error
    if check:
        refuse_penetration(model, placed.name)
    return model


def scene_xml(placed: PlacedScene, *, visual: bool = False) -> str:
    """The MJCF text of a placed scene."""
    check_objects(placed)
    bodies = "".join(_object_xml(thing) for thing in placed.objects)
    bodies += "".join(_particles_xml(group) for group in placed.particles)
    meshes = "".join(_mesh_assets(thing) for thing in placed.objects)
    return (
        "<mujoco>"
        '<compiler angle="radian" autolimits="true" boundmass="1e-6" boundinertia="1e-9"/>'
        f'<option timestep="{TIMESTEP}" integrator="discrete" cone="elliptic" impratio="{IMPRATIO}">'
        '<flag sleep="enable"/></option>'
        '<size memory="64M"/>'
        f"<default>{panda_defaults()}</default><asset>{panda_assets(visual)}{meshes}</asset>"
        f"<worldbody>{_setting_xml(placed)}{panda_body(visual)}{bodies}</worldbody>"
        f"{panda_actuators()}<sensor>{panda_sensors()}{_truth_sensors(placed)}</sensor></mujoco>"
    )


def check_objects(placed: PlacedScene) -> None:
    """Raises BadInputError for objects that cannot be compiled or whose names are not unique."""
    seen: set[str] = set()
    for thing in placed.objects:
        where = f"{placed.name}: object {thing.id!r}"
        if thing.id in seen or thing.id in ("table", "floor", "robot"):
            raise BadInputError("its name is taken", where=where)
        seen.add(thing.id)
        if not thing.geoms:
            raise BadInputError("it has no geometry", where=where)
        if not thing.fixed and not sum(geom.mass for geom in thing.geoms) > 0.0:
            raise BadInputError("it has no mass", where=where)
        for geom in thing.geoms:
            if geom.type == "mesh" and (geom.vertices is None or len(geom.vertices) < 4):
                raise BadInputError("a mesh piece needs at least four vertices", where=where)
    for group in placed.particles:
        if group.container not in seen:
            raise BadInputError(f"particles belong to the unknown object {group.container!r}", where=placed.name)


def refuse_penetration(model: mujoco.MjModel, where: str) -> None:
    """Raises BadInputError naming the two things that overlap most at the start, if any do."""
    data = mujoco.MjData(model)
    from sim.panda import READY

    data.qpos[:7] = READY
    data.qpos[7:9] = 0.04
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    if not data.ncon:
        return
    worst = int(np.argmin(data.contact.dist[: data.ncon]))
    depth = -float(data.contact.dist[worst])
    if depth <= PENETRATION:
        return
    names = [_thing_of(model, int(geom)) for geom in data.contact.geom[worst]]
    raise BadInputError(
        f"{names[0]!r} and {names[1]!r} start {depth * 1e3:.1f} mm inside each other; move them apart", where=where
    )


def _thing_of(model: mujoco.MjModel, geom: int) -> str:
    """Scene id of the thing a geom belongs to ("table", "floor", "robot", an object, or a container's content)."""
    body = int(model.geom_bodyid[geom])
    name = model.body(body).name
    if name.startswith("robot/"):
        return "robot"
    if name.startswith("particle/"):
        return f"content of {name.split('/')[1]}"
    return "floor" if name == "world" else name


def _setting_xml(placed: PlacedScene) -> str:
    """Floor and table."""
    common = (
        f'{GEOM_BITS["setting"]} condim="4" friction="0.5 {TORSION} 0.0002" solref="{SOLREF_HARD} 1" solimp="{SOLIMP}"'
    )
    rgba = _numbers(placed.table_rgba)
    return (
        f'<geom name="floor" type="plane" size="0 0 0.1" pos="0 0 {FLOOR_Z}" {common} rgba="0.32 0.34 0.37 1"/>'
        f'<body name="table" pos="{_numbers(TABLE_CENTRE)}">'
        f'<geom name="table" type="box" size="{_numbers(TABLE_HALF)}" {common} rgba="{rgba}"/></body>'
    )


def _object_xml(thing: PlacedObject) -> str:
    """One object as a free body, or as a static one if it is part of the set-up."""
    softness = SOLREF_SOFT if thing.soft else SOLREF_HARD
    contact = (
        f'{GEOM_BITS["setting" if thing.fixed else "object"]} group="1" priority="1" condim="{6 if thing.soft else 4}" '
        f'friction="{thing.friction:.9g} {TORSION} {ROLLING}" solref="{softness} 1" solimp="{SOLIMP}"'
    )
    joint = "" if thing.fixed else f"<freejoint name={quoteattr(thing.id)}/>"
    geoms = "".join(_geom_xml(thing, index, geom, contact) for index, geom in enumerate(thing.geoms))
    pose = f'pos="{_exact(thing.position)}" quat="{_exact(thing.quaternion)}"'
    return f"<body name={quoteattr(thing.id)} {pose}>{joint}{geoms}</body>"


def _geom_xml(thing: PlacedObject, index: int, geom: Geom, contact: str) -> str:
    name = quoteattr(f"{thing.id}/{index}")
    shape = f"mesh={name}" if geom.type == "mesh" else f'size="{_exact(geom.size)}"'
    return (
        f'<geom name={name} type="{geom.type}" {shape} pos="{_exact(geom.position)}" quat="{_exact(geom.quaternion)}" '
        f'mass="{geom.mass:.9g}" rgba="{_numbers(geom.rgba)}" {contact}/>'
    )


def _mesh_assets(thing: PlacedObject) -> str:
    """Convex pieces by their vertices; MuJoCo collides with their hull."""
    return "".join(
        f'<mesh name={quoteattr(f"{thing.id}/{index}")} vertex="{_exact(geom.vertices.ravel())}"/>'
        for index, geom in enumerate(thing.geoms)
        if geom.type == "mesh" and geom.vertices is not None
    )


def _particles_xml(group: Particles) -> str:
    """The contents of a container as free spheres."""
    contact = (
        f'{GEOM_BITS["object"]} group="1" priority="0" condim="3" friction="{PARTICLE_FRICTION} {TORSION} {ROLLING}" '
        f'solref="{SOLREF_SOFT} 1" solimp="{SOLIMP}" rgba="{_numbers(group.rgba)}"'
    )
    return "".join(
        f'<body name={quoteattr(particle_name(group.container, index))} pos="{_exact(position)}">'
        f"<freejoint name={quoteattr(particle_name(group.container, index))}/>"
        f'<geom type="sphere" size="{group.radius}" mass="{group.mass:.9g}" {contact}/></body>'
        for index, position in enumerate(np.asarray(group.positions, float))
    )


def particle_name(container: str, index: int) -> str:
    """Name of the body and joint of one content sphere."""
    return f"particle/{container}/{index}"


def _truth_sensors(placed: PlacedScene) -> str:
    """Contact sensors for the observer; the robot must not read them.

    `netforce` gives (count, force (3,) on the world axes, force-weighted position (3,)); `maxforce` gives (count, force
    (3,) in the contact's frame with the normal first, position (3,)) of the strongest contact.
    """
    movable = [thing.id for thing in placed.objects if not thing.fixed]
    fixed = [thing.id for thing in placed.objects if thing.fixed]
    text = _contact("truth/table/robot", 'subtree1="robot/link0" body2="table"', "maxforce")
    for index, name in enumerate(movable):
        body = f"body2={quoteattr(name)}"
        for side in ("left", "right"):
            text += _contact(f"truth/{name}/pad_{side}", f'geom1="robot/{side}_pad" {body}', "netforce")
        text += _contact(f"truth/{name}/robot", f'subtree1="robot/link0" {body}', "maxforce")
        text += _contact(f"truth/{name}/table", f'body1="table" {body}', "netforce")
        for other in [*movable[index + 1 :], *fixed]:
            text += _contact(f"truth/{name}/{other}", f"body1={quoteattr(other)} {body}", "netforce")
    return text


def _contact(name: str, between: str, reduce: str) -> str:
    return f'<contact name={quoteattr(name)} {between} num="1" reduce="{reduce}" data="found force pos"/>'


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)


def _exact(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
