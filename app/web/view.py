"""The live 3D view: the Panda's meshes and the objects where physics has them, candidate grasps as grippers with scores.

It shows; pointing at a gripper or clicking it shows its text, and nothing of it reaches physics.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from app.web.gate import VIEW

if TYPE_CHECKING:
    import viser
    from numpy.typing import NDArray

    from kb.grasp import Grasp
    from sim.placed import PlacedScene

FLOOR = "/fixed_bodies/world/floor"
FLOOR_HEIGHT = -0.75
SKY, GROUND = (206, 216, 230), (238, 241, 245)
"""Colours of the backdrop, above and below."""
CHOSEN, OTHER, POINTED = (0, 114, 178), (150, 156, 166), (230, 159, 0)
"""Blue, grey and orange of the palette by Okabe and Ito: told apart by colour-blind people, and labelled besides."""
MAX_SHOWN = 8
"""Most grippers drawn at the same time."""
__all__ = ["VIEW", "Candidate", "View"]


@dataclass(frozen=True)
class Candidate:
    """A grasp to be drawn."""

    name: str
    grasp: Grasp
    score: float
    chosen: bool


class View:
    """The scene of viser's server, shown alike to every page."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._lock = threading.RLock()
        self._pose: Any = None
        self._bodies: Any = None
        self._grippers: dict[str, list[Any]] = {}
        self._candidates: tuple[Candidate, ...] = ()
        self._pointed: str | None = None
        self._clicked: str | None = None
        """The gripper that was clicked keeps its text when the pointer leaves it: a touch screen has no pointer."""
        self._resting = False
        """The motion is over: a gripper is drawn only while somebody points at its row."""
        self._mark: list[Any] = []

    def open(self, placed: PlacedScene, qpos: NDArray[np.float64]) -> None:
        """Replaces what is shown by another scene, its joints at `qpos` (nq,)."""
        from mjviser import ViserMujocoScene

        from sim.visual_pose import VisualPose

        scene = self._server.scene
        with self._lock, self._server.atomic():
            scene.reset()
            scene.set_up_direction("+z")
            self._grippers, self._candidates, self._pointed, self._clicked, self._mark = {}, (), None, None, []
            self._pose = VisualPose(placed)
            self._bodies = ViserMujocoScene(self._server, self._pose.model, 1)
            self._bodies.camera_tracking_enabled = False
            for group in self._bodies._mesh_groups:
                # Shadows that a fine mesh casts on itself look like dirt.
                group.handle.receive_shadow = False
            self._light()
            self._server.gui.configure_theme(show_logo=False, show_share_button=False)
            camera = self._server.initial_camera
            camera.position, camera.look_at, camera.fov = (1.78, -1.42, 0.84), (0.30, 0.04, 0.26), 0.50
        self.show(qpos)

    def _light(self) -> None:
        """Lamps of our own, no environment pictures; a quiet floor and backdrop."""
        scene = self._server.scene
        scene.configure_environment_map(hdri=None)
        scene.configure_default_lights(enabled=False)
        scene.add_light_hemisphere("/lamps/sky", sky_color=(255, 255, 255), ground_color=(150, 150, 160), intensity=1.5)
        scene.add_light_directional(
            "/lamps/key", color=(255, 250, 240), intensity=2.0, cast_shadow=True, position=(1.2, -1.6, 2.6)
        )
        scene.add_light_directional(
            "/lamps/fill", color=(220, 230, 255), intensity=0.6, cast_shadow=False, position=(-1.0, 2.0, 1.5)
        )
        scene.remove_by_name(FLOOR)
        scene.add_grid(
            FLOOR, infinite_grid=True, fade_distance=4.5, cell_size=0.25, section_size=1.0, position=(0, 0, FLOOR_HEIGHT),
            cell_color=(205, 211, 220), section_color=(185, 193, 205), plane_color=(226, 230, 236), shadow_opacity=0.25,
        )  # fmt: skip
        share = np.linspace(0.0, 1.0, 64)[:, None, None]
        scene.set_background_image(
            np.repeat(np.asarray(SKY) * (1 - share) + np.asarray(GROUND) * share, 8, axis=1).astype(np.uint8)
        )

    def show(self, qpos: NDArray[np.float64]) -> None:
        """The joints of robot and objects (nq,) as physics, or a replay, has them."""
        with self._lock:
            if self._pose is not None and len(qpos) == self._pose.model.nq:
                self._bodies.update_from_mjdata(self._pose.at(qpos))

    # Candidate grasps ---------------------------------------------------------------------------------------------

    def candidates(self, candidates: Sequence[Candidate]) -> None:
        """Draws these grasps as grippers, and nothing of earlier ones."""
        with self._lock, self._server.atomic():
            for handles in self._grippers.values():
                _remove(handles)
            self._candidates, self._grippers = tuple(candidates[:MAX_SHOWN]), {}
            self._pointed, self._clicked, self._resting = None, None, False
            for rank, candidate in enumerate(self._candidates, start=1):
                self._grippers[candidate.name] = self._draw(rank, candidate)
            self._colour()

    def rest(self) -> None:
        """The motion is over: the grippers go; one comes back while its row is pointed at."""
        with self._lock, self._server.atomic():
            self._clicked, self._resting = None, True
            self._colour()

    def place(self, point: tuple[float, float] | None) -> None:
        """Marks where something is to be put down (x, y) [m]; None takes the mark away."""
        with self._lock, self._server.atomic():
            _remove(self._mark)
            self._mark = []
            if point is None:
                return
            x, y = point
            scene = self._server.scene
            self._mark = [
                scene.add_cylinder("/place/disc", 0.045, 0.004, color=CHOSEN, opacity=0.7, position=(x, y, 0.003)),
                scene.add_label("/place/label", "here", position=(x, y, 0.05), anchor="bottom-center"),
            ]

    def point(self, name: str | None) -> None:
        """Sets off the gripper of that name, which the pointer is over, there or in the list; None: it has left."""
        with self._lock, self._server.atomic():
            if name != self._pointed:
                self._pointed = name
                self._colour()

    def _click(self, name: str) -> None:
        """A gripper was clicked in the view: its text stays, and goes with the next click on it."""
        with self._lock, self._server.atomic():
            self._clicked = None if name == self._clicked else name
            self._colour()

    def _colour(self) -> None:
        """One gripper at a time has its text, so that two texts never lie over each other."""
        pointed = next((name for name in (self._pointed, self._clicked) if name in self._grippers), None)
        for candidate in self._candidates:
            gripper, label = self._grippers[candidate.name]
            set_off = candidate.name == pointed
            gripper.color = POINTED if set_off else CHOSEN if candidate.chosen else OTHER
            gripper.opacity = 0.85 if set_off else 0.6 if candidate.chosen else 0.4
            gripper.visible = set_off or not self._resting
            label.visible = set_off or (candidate.chosen and pointed is None and not self._resting)

    def _draw(self, rank: int, candidate: Candidate) -> list[Any]:
        from sim.hand import TCP_OFFSET, hand_boxes

        grasp, rotation = candidate.grasp, candidate.grasp.rotation()
        vertices, faces = _boxes(hand_boxes(grasp.aperture))
        vertices = (vertices - (0.0, 0.0, TCP_OFFSET)) @ rotation.T + np.asarray(grasp.position)
        scene = self._server.scene
        gripper = scene.add_mesh_simple(
            f"/candidates/{rank}/gripper", vertices, faces, color=OTHER, opacity=0.4, flat_shading=True,
            cast_shadow=False, receive_shadow=False, side="double",
        )  # fmt: skip
        # Of the pointer viser tells the server of clicks on a part of the scene; hovering is found out by the page.
        gripper.on_click(lambda _event: self._click(candidate.name))
        behind = np.asarray(grasp.position) - 0.15 * rotation[:, 2]
        text = f"#{rank}  score {candidate.score:.2f}  {grasp.type}  {grasp.force:.1f} N"
        label = scene.add_label(
            f"/candidates/{rank}/label", text, position=tuple(behind), anchor="bottom-center", visible=False
        )
        return [gripper, label]


def _remove(handles: Sequence[Any]) -> None:
    for handle in handles:
        handle.remove()


def _boxes(boxes: Sequence[tuple[Any, Any]]) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """Vertices (N, 3) and triangles (M, 3) of boxes given by centre and half size."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.uint32)
    vertices = np.concatenate([np.asarray(centre) + corners * np.asarray(half) for centre, half in boxes])
    faces = np.concatenate([triangles + 8 * number for number in range(len(boxes))])
    return vertices, faces
