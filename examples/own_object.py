"""A scene with your own object: a mesh made here, a scene file beside it, and a run that has never seen either.

python examples/own_object.py [FOLDER]
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh

from agent import build_agent

SCENE = """\
name: workbench
objects:
  - id: knob
    mesh: ./knob.stl
    mass: 0.12
    friction: 0.5
    color: [0.85, 0.45, 0.10]
    position: [0.52, 0.06]
  - {id: block, model: toy_block, near: knob, gap: 0.09, bearing: 1.2}
randomise: {mass: 0.2, friction: 0.2}
"""


def make_knob(path: Path) -> None:
    """An eight-sided knob on a foot: 44 mm thick, 70 mm high; nothing the catalogue has."""
    foot = trimesh.creation.cylinder(radius=0.030, height=0.014, sections=32)
    foot.apply_translation([0.0, 0.0, 0.007])
    knob = trimesh.creation.cylinder(radius=0.022, height=0.058, sections=8)
    knob.apply_translation([0.0, 0.0, 0.041])
    mesh = trimesh.util.concatenate([foot, knob])
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 16, [0, 0, 1]))
    mesh.export(path)


def main() -> None:
    """Writes mesh and scene, then asks for the thing by its colour."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="workbench-"))
    folder.mkdir(parents=True, exist_ok=True)
    make_knob(folder / "knob.stl")
    scene = folder / "workbench.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    result = build_agent(scene=str(scene), seed=1).run("pick up the orange thing")
    print(result.answer)
    print(f"observed: {'success' if result.success else 'no success'}; the scene is in {folder}")


if __name__ == "__main__":
    main()
