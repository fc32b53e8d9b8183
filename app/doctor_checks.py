"""The single checks of `ragvlm doctor`. Each returns a finding; what it raises is turned into one."""

from __future__ import annotations

import os
import shutil
import sys
from functools import cache
from importlib import metadata, util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.doctor import Finding

if TYPE_CHECKING:
    from sim.world import World

FK_TOLERANCE = 1e-6
"""Model and analytic forward kinematics agree to this [m]."""
DRIFT = 0.002
"""The hand may sag this much while it holds still [m] (calibration gate a)."""


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
    """Conversations can be stored."""
    folder = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    nearest = next(parent for parent in (folder, *folder.parents) if parent.exists())
    if os.access(nearest, os.W_OK):
        return Finding(True, str(folder))
    return Finding(False, f"{nearest} is read-only", "make it writable, or set XDG_STATE_HOME to a folder of yours")


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
