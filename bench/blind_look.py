"""Oracle perception of the analytic evaluator without a picture: nothing is rendered.

Positions, kinds and shapes come from the truth with the errors of `tools.noisy_oracle`, as always there. What a picture
would add is taken from elsewhere, and said so in `docs/benchmark.md`: how much of an object the front camera sees follows
from the camera's pose alone, and the visual embedding is one of those stored in the knowledge base for the object's
category, drawn with the seed of the world. An object whose category the knowledge base does not know has none.
"""

from __future__ import annotations

import zlib
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from kb.percept import PerceivedObject, Percept
from kb.rgbd import RgbdView
from sim.cameras import focal_length
from sim.placed import PlacedScene
from tools.perceive import PerceiveArgs


class BlindOracle:
    """A perceiver that is given no pictures; the same seed gives the same percepts."""

    name = "oracle"

    def __init__(self, oracle: Any, placed: PlacedScene, store: Any, seed: int) -> None:
        self._oracle = oracle
        self._views = tuple(_unseen(camera) for camera in placed.cameras if camera.name in ("front", "top"))
        self._store = store
        self._seed = seed
        self._known: dict[tuple[object, ...], PerceivedObject] = {}
        """Name, place, size and state -> what was last seen so."""

    def perceive(self, views: Any, args: PerceiveArgs) -> Percept:
        """What the oracle reports, with embeddings of the knowledge base; `views` are not looked at."""
        del views
        percept: Percept = self._oracle.perceive(self._views, args)
        seen = tuple(item.model_copy(update={"embedding": self._embedding(item.category)}) for item in percept.objects)
        return percept.model_copy(update={"objects": tuple(self._as_known(item) for item in seen)})

    def _as_known(self, item: PerceivedObject) -> PerceivedObject:
        """The same object if it was seen just so before: what was worked out for it is kept for that very object.

        Configurations that handle things in another order meet the others where they stood.
        """
        key = item.id, item.position, item.size, item.state
        known = self._known.get(key)
        if known is None or known != item:
            known = self._known[key] = item
        return known

    def _embedding(self, category: str) -> tuple[float, ...]:
        entries = _embeddings(self._store, category)
        if not entries:
            return ()
        rng = np.random.default_rng([self._seed, zlib.crc32(category.encode())])
        return entries[int(rng.integers(len(entries)))]


_known: WeakKeyDictionary[Any, dict[tuple[str, int], list[tuple[float, ...]]]] = WeakKeyDictionary()
"""Store -> category and size of the store -> embeddings: every look of every trial asks for the same few categories."""


def _embeddings(store: Any, category: str) -> list[tuple[float, ...]]:
    """Embeddings that the store has of a category, in its order."""
    known, key = _known.setdefault(store, {}), (category, len(store))
    if key not in known:
        known[key] = [entry.embedding for entry in store.by_category(category) if entry.embedding]
    return known[key]


def _unseen(camera: Any) -> RgbdView:
    """The calibration of a camera with a picture that takes no memory and shows nothing."""
    return RgbdView(
        name=camera.name,
        rgb=np.broadcast_to(np.uint8(0), (camera.height, camera.width, 3)),
        depth=np.broadcast_to(np.float32(0), (camera.height, camera.width)),
        focal=focal_length(camera),
        transform_camera_to_world=camera.told_pose.copy(),
    )
