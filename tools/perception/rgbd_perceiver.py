"""The default perceiver: from two noisy RGB-D pictures to a percept, by geometry and reference statistics.

It knows the cameras' calibration, the table's size and what categories look like; never the scene's truth.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kb.base import Vec3
from kb.percept import Part, PerceivedObject, Percept, Shape, pack_surface
from kb.priors import density, prior
from kb.references import References, load_references
from kb.rgbd import RgbdView
from kb.vocabulary import UNKNOWN_CATEGORY, ObjectState, PerceptionName
from tools.perceive import PerceiveArgs
from tools.perception.affordance_of_unknown import affordance_of_unknown
from tools.perception.blob import CLEAR_LOSS, Blob
from tools.perception.colour import colour_name, mean_colour
from tools.perception.look import Look, take_apart
from tools.perception.measure import Measured
from tools.perception.merge import Candidate, Merger
from tools.perception.parts import find_parts
from tools.perception.round_core import has_loop, is_stub, round_core
from tools.perception.slim_end import slim_end
from tools.perception.state import state_of
from tools.perception.track_ids import track_ids
from tools.perception.visibility import visible_fraction

GHOST_POINTS, GHOST_HEIGHT = 120, 0.012
"""A flat blob lower than the second [m] with fewer points than the first that one view alone sees is edge noise."""

FAINT_POINTS, FAINT_HEIGHT = 300, 0.0062
"""The same for so few points at so low a median height [m]: the table's own noise at its edge."""

IN_VIEW = 0.25
"""What the front camera doesn't see although nothing hides more than the rest of it is no flat thing."""

FLOATING = 0.06
"""What has nothing under it within this distance is not on the table [m]: the hand, or what it holds."""

FEWEST_EMBEDDED = 60
"""Pixels of the front view that an embedding needs; with fewer the top view serves."""

WIDEST_HANDLE = 0.040
"""What is thicker is no handle but the head of a tool [m]."""

FOAMY = 2.0
"""Density of the lightest things that one expects over that of the lightest foam."""

DENT = 0.15
"""A hollow as shallow as this share of a strange thing's height, all of one colour, is its shape and not what fills it."""

SOLIDITY = 0.8
"""Share of hull area times height that an unknown object is taken to fill, for its mass."""


class Embeds(Protocol):
    """The embedder's one method."""

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None
    ) -> NDArray[Any]: ...


class RgbdPerceiver:
    """Perceives objects from the front and the top picture."""

    name: PerceptionName = "rgbd"

    def __init__(self, embedder: Embeds | None = None, references: References | None = None) -> None:
        self._embedder = embedder
        self._references = load_references() if references is None else references

    def perceive(self, views: tuple[RgbdView, ...], args: PerceiveArgs) -> Percept:
        """All objects on the table.

        Raises:
            BadInputError: if the front or the top view is missing.
        """
        look = take_apart(views)
        found = [item for item in Merger(look, self._references, args.nouns).objects() if _is_real(item, look)]
        objects = [self._describe(item, look) for item in found]
        return Percept(look=args.look, perception="rgbd", objects=track_ids(objects, args.previous), noise=look.noise)

    def _describe(self, item: Candidate, look: Look) -> PerceivedObject:
        measured, judgement = item.measured, item.judgement
        unknown = judgement.category == UNKNOWN_CATEGORY
        core = round_core(measured) if unknown else None
        if core is not None and has_loop(find_parts(core)):
            measured = core
        parts = tuple(part for part in find_parts(measured) if not (unknown and is_stub(part)))
        if unknown and not measured.is_round and not measured.is_ball:
            slim = (
                ()
                if any(part.region == "handle" and part.width < WIDEST_HANDLE for part in parts)
                else slim_end(measured)
            )
            parts = (*slim, *(part for part in parts if not slim or part.region not in ("handle", "edge")))
        transparent = measured.lost > CLEAR_LOSS
        afforded = affordance_of_unknown(measured, parts, transparent=transparent) if unknown else None
        expected = prior(judgement.category)
        position = _vec(measured.box.centre)
        colour = mean_colour((measured.blob.rgb * 255).astype(np.uint8))
        front = next(view for view in look.views if view.name == "front")
        return PerceivedObject(
            id="obj_0",
            category=judgement.category,
            confidence=judgement.confidence,
            posterior=judgement.posterior,
            position=position,
            yaw=float(measured.box.yaw),
            size=_vec(measured.box.size),
            shape=shape_of(measured),
            affordance=expected.affordance if afforded is None else afforded.descriptor,
            affordance_confidence=1.0 if afforded is None else afforded.confidence,
            fragility_range=None if afforded is None else afforded.fragility_range,
            state=_state(item, measured, parts),
            transparent=transparent,
            colour=colour,
            colour_name=colour_name(colour),
            mass=_mass_of_unknown(measured) if unknown else expected.mass,
            friction=expected.friction,
            parts=parts,
            visible_fraction=visible_fraction(measured, front),
            embedding=self._embed(measured.blob, look),
            surface=pack_surface(measured.blob.xyz, position),
        )

    def _embed(self, blob: Blob, look: Look) -> tuple[float, ...]:
        """Embedding of the masked crop, from the front view if enough of the object is seen there."""
        if self._embedder is None:
            return ()
        front, top = int((~blob.from_top).sum()), int(blob.from_top.sum())
        seen_in_front = front >= FEWEST_EMBEDDED or front >= top
        view = next(view for view in look.views if view.name == ("front" if seen_in_front else "top"))
        pixels = blob.pixel[~blob.from_top if seen_in_front else blob.from_top]
        mask = np.zeros(view.depth.size, bool)
        mask[pixels] = True
        mask = mask.reshape(view.depth.shape)
        rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
        crop = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        vector = self._embedder.embed(view.rgb[crop], mask[crop], view.depth[crop])
        return tuple(float(value) for value in vector)


def _state(item: Candidate, measured: Measured, parts: tuple[Part, ...]) -> ObjectState:
    """Empty, filled or stacked."""
    shallow = measured.top - measured.base < measured.radius
    if shallow and item.judgement.category == UNKNOWN_CATEGORY and not item.contents and item.under is None:
        return "empty"  # how deep a plate or a strange bowl ought to be is not known
    dent = measured.hollow < DENT and item.judgement.category == UNKNOWN_CATEGORY
    if dent and not item.contents and item.under is None:
        return "empty"
    return state_of(
        measured,
        parts,
        stands_on_object=item.under is not None,
        holds_object=item.holds,
        contents_seen=bool(item.contents),
    )


def _is_real(item: Candidate, look: Look) -> bool:
    """Neither a ghost of edge noise nor something in the air."""
    m = item.measured
    share = float(m.blob.from_top.mean())
    one_view = share < 0.04 or share > 0.96
    if one_view and m.top - m.base < GHOST_HEIGHT and len(m.blob.xyz) < GHOST_POINTS:
        return False
    if one_view and len(m.blob.xyz) < FAINT_POINTS and float(np.median(m.blob.xyz[:, 2])) < FAINT_HEIGHT:
        return False
    if share > 0.96 and m.top - m.base < GHOST_HEIGHT:
        front = next(view for view in look.views if view.name == "front")
        if visible_fraction(m, front) > IN_VIEW:
            return False  # nothing hides it from the front camera, which sees bare table there
    lowest = float(np.quantile(m.blob.xyz[:, 2], 0.02))
    return lowest - m.base < FLOATING + 0.5 * m.radius


def shape_of(m: Measured) -> Shape:
    """Coarse geometric family."""
    longer, shorter, height = m.box.size
    if m.is_ball:
        return "sphere"
    if m.is_round:
        if m.hollow > 0 and height < 0.8 * 2 * m.radius:
            return "bowl"
        radii = m.profile[np.isfinite(m.profile)]
        straight = len(radii) > 0 and float(np.min(radii)) > 0.85 * m.radius
        return "cylinder" if straight and m.hollow <= 0 and m.bulge < 0.15 * m.radius else "compound"
    if height < 0.25 * shorter and height < 0.03:
        return "plate"
    if longer > 2.5 * shorter and height < 0.5 * longer:
        return "bar"
    return "box" if m.outline.hull_area > 0.9 * longer * shorter else "compound"


def _mass_of_unknown(m: Measured) -> tuple[float, float]:
    """Mass range [kg] from the volume: anything between a hollow or foamy thing and a solid of mixed material."""
    volume = m.outline.hull_area * (m.top - m.base) * SOLIDITY * (0.35 if m.hollow > 0 else 1.0)
    low, high = density("foam")[0] * FOAMY, density("mixed")[1]
    return float(max(low * volume, 0.003)), float(max(high * volume, 0.01))


def _vec(values: NDArray[np.float64]) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
