"""Single things on the table, rendered as the robot's cameras see them: catalogue objects and shapes outside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kb.affordance import AffordanceDescriptor
from kb.rgbd import RgbdView
from kb.vocabulary import UNKNOWN_CATEGORY
from sim.cameras import draw_cameras
from sim.catalogue import MODELS
from sim.particles import fill
from sim.placed import Geom, Particles, PlacedObject, PlacedScene
from sim.world import World

MODELS_SEEN: tuple[str, ...] = tuple(name for name in MODELS if not MODELS[name].fixed)
"""Catalogue objects that can stand on the table."""

SIZES = 0.10
"""Reference views vary the size by this much to either side: twice the spread of the catalogue's instances."""


def reference_view(name: str, seed: int) -> tuple[str, tuple[RgbdView, ...]]:
    """Category and pictures of one catalogue object in a random pose, size, colour and light."""
    rng = np.random.default_rng([seed, 1])
    entry = MODELS[name]
    scale = float(rng.uniform(1 - SIZES, min(1 + SIZES, entry.largest + SIZES / 2)))
    thing = put(entry.draw(rng, id="thing", size_scale=scale), rng)
    contents = (fill(thing, rng),) if entry.category in FILLED and seed % 2 else ()
    return entry.category, render((thing,), rng, contents)


FILLED = ("cup", "mug", "bowl")
"""Of these every other view shows a filled one."""


def random_shape_view(seed: int) -> tuple[str, tuple[RgbdView, ...]]:
    """Pictures of one shape that is in no catalogue."""
    rng = np.random.default_rng([seed, 2])
    return UNKNOWN_CATEGORY, render((put(random_shape(rng, "thing"), rng),), rng)


def put(thing: PlacedObject, rng: np.random.Generator) -> PlacedObject:
    """The thing somewhere on the table, turned anyhow about the vertical."""
    turn = float(rng.uniform(-np.pi, np.pi))
    place = (float(rng.uniform(0.36, 0.74)), float(rng.uniform(-0.29, 0.29)), 0.0)
    return replace(thing, position=place, quaternion=(float(np.cos(turn / 2)), 0.0, 0.0, float(np.sin(turn / 2))))


def render(
    things: tuple[PlacedObject, ...], rng: np.random.Generator, contents: tuple[Particles, ...] = ()
) -> tuple[RgbdView, ...]:
    """Both cameras' pictures of the things under random light on a random table."""
    light = rng.normal(size=3)
    tint = np.clip(rng.uniform(0.3, 0.9) * (1 + rng.uniform(-0.15, 0.15, 3)), 0.05, 0.98)
    placed = PlacedScene(
        name="reference",
        seed=0,
        objects=things,
        particles=contents,
        cameras=draw_cameras(rng),
        light=(float(light[0]), float(light[1]), float(abs(light[2]) + 1.0)),
        ambient=float(rng.uniform(0.35, 0.6)),
        table_rgba=(float(tint[0]), float(tint[1]), float(tint[2]), 1.0),
        extras={
            "table_contrast": float(rng.uniform(0.0, 0.3)),
            "table_grain": float(rng.uniform(0.02, 0.08)),
            "table_turn": float(rng.uniform(0.0, np.pi)),
        },
    )
    world = World(placed, settle=False)
    return world.capture(rng)


def random_shape(rng: np.random.Generator, name: str) -> PlacedObject:
    """A solid of one or two random primitive pieces, at most 75 mm wide where the hand would span it."""
    kind = rng.choice(["box", "cylinder", "ell", "tee", "dome", "cone_stack", "slab", "capsule"])
    r, g, b = rng.uniform(0.05, 0.95, 3)
    rgba = (float(r), float(g), float(b), 1.0)
    pieces = _pieces(str(kind), rng)
    geoms = tuple(replace(piece, rgba=rgba, mass=0.1) for piece in pieces)
    affordance = AffordanceDescriptor(type="GRASPABLE_BODY", material="plastic", fragility=0.1, region="body")
    return PlacedObject(
        id=name,
        model=name,
        category=UNKNOWN_CATEGORY,
        affordance=affordance,
        geoms=geoms,
        position=(0.5, 0.0, 0.0),
        quaternion=(1.0, 0.0, 0.0, 0.0),
        size=(0.1, 0.1, 0.1),
        mass=0.1 * len(geoms),
        friction=0.5,
        damage_force=70.0,
    )


def _pieces(kind: str, rng: np.random.Generator) -> list[Geom]:
    a, b, c = rng.uniform(0.010, 0.036, 3).tolist()
    long, tall = float(rng.uniform(0.04, 0.09)), float(rng.uniform(0.02, 0.08))
    flat = float(rng.uniform(0.005, 0.012))
    side = (np.sqrt(0.5), 0.0, float(np.sqrt(0.5)), 0.0)
    lying = (float(side[0]), 0.0, float(side[2]), 0.0)
    if kind == "box":
        return [Geom("box", (long, a, tall), (0.0, 0.0, tall))]
    if kind == "cylinder":
        return [Geom("cylinder", (a, tall), (0.0, 0.0, tall))]
    if kind == "ell":
        return [Geom("box", (long, a, b), (0.0, 0.0, b)), Geom("box", (a, long * 0.6, b), (long - a, long * 0.6, b))]
    if kind == "tee":
        return [Geom("box", (long, a, b), (0.0, 0.0, b)), Geom("box", (a, long * 0.5, b), (0.0, long * 0.5 + a, b))]
    if kind == "dome":
        return [Geom("ellipsoid", (a + 0.01, b + 0.01, c), (0.0, 0.0, c))]
    if kind == "cone_stack":
        return [
            Geom("cylinder", (a + 0.012, tall / 2), (0.0, 0.0, tall / 2)),
            Geom("cylinder", (a * 0.5 + 0.004, tall / 2), (0.0, 0.0, 1.5 * tall)),
        ]
    if kind == "slab":
        return [Geom("box", (long, a + 0.02, flat), (0.0, 0.0, flat))]
    return [Geom("capsule", (a * 0.6 + 0.004, long), (0.0, 0.0, a * 0.6 + 0.004), lying)]
