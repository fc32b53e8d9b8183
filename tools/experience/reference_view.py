"""Renders the reference view of an entry again, from the seed of its first trial."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kb.errors import EnvironmentFaultError
from kb.experience import Experience
from kb.reference_views import ReferenceView, cropped, view_key
from kb.shape_colour import ShapeColourEmbedder
from sim.draw_scene import draw_scene
from sim.robot import Robot
from sim.world import World
from tools.experience.recipe import category_plans
from tools.experience.trial import trial_scene
from tools.oracle_perception import OraclePerceiver
from tools.perceive import PerceiveArgs

ALIKE = 0.999
"""Cosine of the rendered view's descriptor with the stored one: less means another simulator or catalogue."""


class ViewTaker:
    """Stands in for an embedder and keeps the picture that it was given."""

    def __init__(self) -> None:
        self.view: ReferenceView | None = None

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None
    ) -> NDArray[np.float64]:
        """Keeps the masked crop; returns nothing of use."""
        self.view = cropped(rgb, mask, depth)
        return np.zeros(1)


def render_view(entry: Experience) -> ReferenceView:
    """The front camera's view of the first trial of `entry`, cut out by the true mask.

    Raises:
        EnvironmentFaultError: if no model of the category gives the picture that the entry was embedded from.
    """
    embedder = ShapeColourEmbedder()
    models = next((plan.models for plan in category_plans() if plan.category == entry.category), ())
    for model in models:
        view = _view(model, entry.seeds[0])
        if view is None:
            continue
        again = embedder.embed(view.rgb, view.mask, view.depth)
        stored = np.asarray(entry.embedding)
        if entry.embedder != embedder.name or float(again @ stored) / float(np.linalg.norm(stored)) > ALIKE:
            return view
    raise EnvironmentFaultError(
        f"the reference view of {entry.id!r} cannot be rendered again: the entry comes from another catalogue or seed",
        mend="rebuild the knowledge base with `ragvlm kb build`",
    )


def render_views(
    entries: tuple[Experience, ...], progress: Callable[[int, int], None] | None = None
) -> dict[str, ReferenceView]:
    """The views of all entries by key."""
    views: dict[str, ReferenceView] = {}
    for done, entry in enumerate(entries, start=1):
        views[view_key(entry)] = render_view(entry)
        if progress is not None:
            progress(done, len(entries))
    return views


def _view(model: str, seed: int) -> ReferenceView | None:
    world = World(draw_scene(trial_scene(model), seed))
    rng = np.random.default_rng([seed, 1])
    taker = ViewTaker()
    OraclePerceiver(world, taker).perceive(tuple(Robot(world).look(rng, ("front",))), PerceiveArgs())
    return taker.view
