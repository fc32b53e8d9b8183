"""Makes the pictures of the documentation again, from real runs, with the project's own ray-cast painter.

python docs/images/make_pictures.py [--quick]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from agent import build_agent
from sim.picture import FINE, PictureMaker
from sim.picture_rays import SHOWPIECE
from sim.video import MotionSampler
from sim.viewpoint import Viewpoint
from tools.draw_scene_graph import draw_scene_graph

HERE = Path(__file__).parent
FRONT_PAGE = Viewpoint(eye=(1.38, 0.84, 0.62), target=(0.335, -0.045, 0.262), fovy=36.5)
SIZE = (1280, 720)


def main() -> None:
    """Writes panda_cup_vase.png and scene_graph.png beside this file."""
    quick = "--quick" in sys.argv
    agent = build_agent(scene="cup_near_vase", seed=8)
    sampler = MotionSampler()
    agent.opened.world.recorders.append(sampler)
    result = agent.run("pick up the cup next to the vase")
    print(result.answer, "observed:", result.success)
    lifted = [moment.qpos for moment in sampler.moments if moment.phase == "lift"]
    with PictureMaker(agent.opened.placed, "raycast") as maker:
        width, height = (SIZE[0] // 2, SIZE[1] // 2) if quick else SIZE
        picture = maker.picture(lifted[len(lifted) * 3 // 4], FRONT_PAGE, width, height, FINE if quick else SHOWPIECE)
    save(picture, "panda_cup_vase.png")

    agent = build_agent(scene=str(HERE.parents[1] / "examples" / "busy_table.yaml"), seed=4)
    steps = list(agent.stream("what is near the cup"))
    percept = next(step.percept for step in steps if step.kind == "look")
    graph = next(step.graph for step in steps if step.kind == "graphed")
    front = next(view for view in agent.views if view.name == "front")
    drawn = Image.fromarray(draw_scene_graph(front, percept, graph))
    save(
        np.asarray(drawn.resize((drawn.width * 2 // 3, drawn.height * 2 // 3), Image.Resampling.LANCZOS)),
        "scene_graph.png",
    )


def save(picture: np.ndarray, name: str) -> None:
    """Writes a PNG of moderate size."""
    Image.fromarray(picture).save(HERE / name, optimize=True)
    print(name, (HERE / name).stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main()
