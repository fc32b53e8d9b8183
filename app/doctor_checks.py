"""The single checks of `ragvlm doctor`. Each returns a finding; what it raises is turned into one."""

from __future__ import annotations

import os
import shutil
import sys
from functools import cache
from importlib import metadata, util
from typing import TYPE_CHECKING

import numpy as np

from app.doctor import REINSTALL, Finding

if TYPE_CHECKING:
    from sim.world import World

FK_TOLERANCE = 1e-6
"""Model and analytic forward kinematics agree to this [m]."""
DRIFT = 0.002
"""The hand may sag this much while it holds still [m] (calibration gate a)."""
SLIP, CREEP = 0.005, 1e-4
"""A firmly held cube may slip this much in lift and shake [m], and creep this fast [m/s] (30 s within gate a)."""


def python() -> Finding:
    """The interpreter's version."""
    fits = (3, 11) <= sys.version_info[:2] <= (3, 13)
    word = ".".join(map(str, sys.version_info[:3]))
    return Finding(fits, word, "" if fits else "use Python 3.11, 3.12 or 3.13")


def packages() -> Finding:
    """The core packages and their versions."""
    names = ("mujoco", "numpy", "frankik", "langgraph", "pydantic", "chromadb")
    return Finding(True, ", ".join(f"{name} {metadata.version(name)}" for name in names))


def kinematics() -> Finding:
    """Forward kinematics of the compiled model against the closed form, on random configurations."""
    from sim.kinematics_error import kinematics_error

    worst = kinematics_error(_world(), np.random.default_rng(0))
    return Finding(worst < FK_TOLERANCE, f"model and closed form differ by at most {worst:.1e} m", "")


def reach() -> Finding:
    """Inverse kinematics against forward kinematics, and the share of the table that the hand reaches from above."""
    from kb.grasp import Grasp
    from sim.kinematics import forward
    from sim.reach import Reach, solve_reach

    reached, worst, total = 0, 0.0, 0
    for x in np.linspace(0.30, 0.80, 6):
        for y in np.linspace(-0.35, 0.35, 6):
            grasp = Grasp(
                position=(float(x), float(y), 0.05), approach=(0.0, 0.0, -1.0), yaw=0.0, aperture=0.06, force=10.0,
                type="pinch",
            )  # fmt: skip
            total += 1
            found = solve_reach(grasp)
            if isinstance(found, Reach):
                reached += 1
                worst = max(worst, float(np.linalg.norm(forward(found.joints)[:3, 3] - grasp.position)))
    good = worst < 1e-3 and reached > total / 2
    return Finding(good, f"{reached} of {total} places of the table from above, worst residual {worst * 1e3:.2f} mm")


def cameras() -> Finding:
    """Both cameras see the table at a plausible depth."""
    world = _world()
    words, good = [], True
    for view in world.capture(np.random.default_rng(0)):
        known = view.depth > 0
        share, middle = float(known.mean()), float(np.median(view.depth[known])) if known.any() else 0.0
        good &= share > 0.3 and 0.2 < middle < 2.0
        words.append(f"{view.name} {view.depth.shape[1]}x{view.depth.shape[0]}, median {middle:.2f} m")
    return Finding(good, "; ".join(words))


def hold() -> Finding:
    """The arm holds still under its controller for a simulated second."""
    world = _world()
    before = world.read("robot/tcp_position")
    world.settle(1.0)
    drift = float(np.linalg.norm(world.read("robot/tcp_position") - before))
    return Finding(drift < DRIFT, f"the hand sags {drift * 1e3:.3f} mm in a second")


def grip() -> Finding:
    """A cube is gripped, lifted, shaken and held: it must not slip out of the hand, nor creep in it."""
    from kb.grasp import Grasp
    from sim.draw_scene import draw_scene
    from sim.robot import Robot
    from sim.scene_file import load_scene
    from sim.world import World

    world = World(draw_scene(load_scene("single_cube"), 0))
    cube = next(thing for thing in world.placed.objects if not thing.fixed)
    body = world.model.body(cube.id).id

    def offset() -> np.ndarray:
        return world.data.xpos[body] - world.read("robot/tcp_position")

    x, y, z = cube.position
    yaw = 2 * float(np.arctan2(cube.quaternion[3], cube.quaternion[0]))
    grasp = Grasp(
        position=(x, y, z + cube.size[2] / 2), approach=(0.0, 0.0, -1.0), yaw=yaw, aperture=0.08, force=15.0,
        type="power",
    )  # fmt: skip
    sensed = Robot(world).grasp(grasp)
    held = offset()
    world.settle(5.0)
    creep = float(np.linalg.norm(offset() - held)) / 5.0
    slip = abs(float(held[2]) - (z - grasp.position[2]))
    good = sensed.load_end > 0.5 * cube.mass and slip < SLIP and creep < CREEP
    return Finding(
        good,
        f"a cube of {cube.mass * 1e3:.0f} g is held (felt: {sensed.load_end * 1e3:.0f} g); slip {slip * 1e3:.1f} mm "
        f"through lift and shake, creep {creep * 1e3:.3f} mm/s",
        "" if good else REINSTALL,
    )


def pictures() -> Finding:
    """How pictures for people are painted here."""
    from sim.picture import DRAFT, PictureMaker

    world = _world()
    with PictureMaker(world.placed) as maker:
        picture = maker.picture(world.data.qpos, width=160, height=90, finish=DRAFT)
        kind = maker.kind
    blank = float(picture.std()) < 5.0
    if blank:
        return Finding(False, f"{kind}, but the picture is blank", "set MUJOCO_GL=osmesa or disable")
    if kind == "opengl":
        return Finding(True, "OpenGL")
    nicer = "for faster videos: apt install libosmesa6, or libegl1 libegl-mesa0 libgl1-mesa-dri"
    return Finding(True, "ray-cast (there is no OpenGL here; everything works without)", nicer)


def video() -> Finding:
    """The kind of video that a record gets."""
    encoder = shutil.which("ffmpeg")
    if encoder:
        return Finding(True, f"mp4 by {encoder}")
    return Finding(True, "animated GIF (no ffmpeg on the path)", "for mp4: apt install ffmpeg", optional=True)


def knowledge_base() -> Finding:
    """The knowledge base opens, is not empty and answers."""
    from kb.store import ExperienceStore

    store = ExperienceStore.open()
    entries = store.all()
    if not entries:
        return Finding(False, "it is empty", "ragvlm kb build --out kb/data/experiences.jsonl")
    good = sum(entry.success for entry in entries)
    return Finding(True, f"{len(entries)} experiences ({good} successes), embedded by {store.embedder_name}")


def state_folder() -> Finding:
    """Conversations (`--thread`) can be kept."""
    from agent.checkpoint import default_threads

    folder = default_threads().absolute().parent
    nearest = next(parent for parent in (folder, *folder.parents) if parent.exists())
    if nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK):
        return Finding(True, str(folder))
    return Finding(False, f"{nearest} cannot be written", "set RAGVLM_HOME to a folder of yours")


def models() -> Finding:
    """Whether the optional models are installed. They are not needed for anything that is built in now."""
    missing = [name for name in ("torch", "transformers", "open_clip") if util.find_spec(name) is None]
    if missing:
        return Finding(
            False, f"not installed: {', '.join(missing)} (optional)", "pip install 'agentic-rag-vlm[models]'"
        )
    return Finding(True, "installed")


@cache
def _world() -> World:
    """A small world, compiled once for all checks."""
    from sim.draw_scene import draw_scene
    from sim.scene_file import load_scene
    from sim.world import World

    return World(draw_scene(load_scene("single_cube"), 0))
