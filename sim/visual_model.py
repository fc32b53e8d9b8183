"""The model that pictures are made from: physics with the Panda's own meshes, a pedestal, table legs and stands.

It has the same joints in the same order as the physical model, so that its states can be shown; it is never simulated.
"""

from __future__ import annotations

import mujoco

from sim.build_model import FLOOR_Z, TABLE_CENTRE, TABLE_HALF, scene_xml
from sim.placed import PlacedScene

MESH_COLOURS: dict[str, tuple[float, float, float, float]] = {
    **{f"link{number}": (0.95, 0.95, 0.96, 1.0) for number in range(8)},
    "hand": (0.93, 0.93, 0.94, 1.0),
    "finger": (0.20, 0.21, 0.23, 1.0),
}
"""The Panda is white; its fingers are dark."""
METAL = (0.30, 0.32, 0.35, 1.0)
"""Pedestal, legs and stands."""
LARGEST = (1280, 720)
"""Largest OpenGL picture [px]."""
HORIZON, ZENITH = (0.82, 0.84, 0.87), (0.94, 0.95, 0.97)
"""Colours of the backdrop."""
SHADOW_SIZE = 1536
"""Pixels of the shadow map along a side: sharp enough, and cheap in software."""


def visual_model(placed: PlacedScene) -> mujoco.MjModel:
    """Compiles the scene for pictures. Joint positions of the physical model fit it unchanged."""
    spec = mujoco.MjSpec.from_string(scene_xml(placed, visual=True))
    for geom in spec.geoms:
        if geom.meshname in MESH_COLOURS:
            geom.rgba = MESH_COLOURS[geom.meshname]
        elif geom.name == "floor":
            geom.rgba = (0.80, 0.82, 0.85, 1.0)
    _box(spec, (-0.04, 0.0, FLOOR_Z / 2 - 0.02), (0.13, 0.13, -FLOOR_Z / 2 - 0.02))
    _box(spec, (-0.04, 0.0, -0.015), (0.17, 0.17, 0.012))
    for side_x in (-1, 1):
        for side_y in (-1, 1):
            x = TABLE_CENTRE[0] + side_x * (TABLE_HALF[0] - 0.035)
            y = TABLE_CENTRE[1] + side_y * (TABLE_HALF[1] - 0.035)
            height = -FLOOR_Z - 2 * TABLE_HALF[2]
            _box(spec, (x, y, FLOOR_Z + height / 2), (0.022, 0.022, height / 2))
    for thing in placed.objects:
        if thing.fixed and thing.position[2] > FLOOR_Z + 0.05:
            height = thing.position[2] - FLOOR_Z
            half = (thing.size[0] * 0.3, thing.size[1] * 0.3, height / 2)
            _box(spec, (thing.position[0], thing.position[1], FLOOR_Z + height / 2), half)
    _studio(spec)
    return spec.compile()


def _studio(spec: mujoco.MjSpec) -> None:
    """Sky and fog of OpenGL pictures: the floor runs out into a quiet gradient, so that there is no horizon."""
    spec.visual.global_.offwidth, spec.visual.global_.offheight = LARGEST
    spec.visual.map.znear, spec.visual.map.zfar = 0.02, 12.0
    spec.visual.map.fogstart, spec.visual.map.fogend = 2.0, 4.2
    spec.visual.rgba.fog = (*HORIZON, 1.0)
    spec.visual.quality.shadowsize = SHADOW_SIZE
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=ZENITH, rgb2=HORIZON, width=256, height=256 * 6,
    )  # fmt: skip


def _box(spec: mujoco.MjSpec, position: tuple[float, float, float], half: tuple[float, float, float]) -> None:
    """A box that only pictures see."""
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, pos=position, size=half, rgba=METAL, contype=0, conaffinity=0, group=0
    )
