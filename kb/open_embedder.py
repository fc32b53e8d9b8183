"""Opens the visual embedder of a name: the values of `--embedder`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kb.embedder import BatchEmbedder, Embedder
from kb.errors import BadInputError
from kb.reference_views import ReferenceView

CORE = "shape_colour"
CHOICES = (CORE, "efficientnet", "clip", "clip:TAG", "clip:/path.safetensors")


def open_embedder(word: str = CORE) -> Embedder:
    """The embedder of that word; a learnt one loads its weights.

    Args:
        word: "shape_colour", "efficientnet", "clip" (OpenAI's weights by tag), "clip:TAG", "clip:FILE".
            "clip-quickgelu:FILE" is for files with OpenAI's original weights.

    Raises:
        BadInputError: an unknown word, tag or file.
        EnvironmentFaultError: the extra is not installed or the weights cannot be loaded.
    """
    kind, _, rest = word.partition(":")
    if word == CORE:
        from kb.shape_colour import ShapeColourEmbedder

        return ShapeColourEmbedder()
    if word == "efficientnet":
        from kb.efficientnet_embedder import EfficientNetEmbedder

        return EfficientNetEmbedder()
    if kind in ("clip", "clip-quickgelu") and (rest or word == "clip"):
        from kb.clip_embedder import DEFAULT_TAG, ClipEmbedder

        return ClipEmbedder(rest or DEFAULT_TAG, quick_gelu=True if kind == "clip-quickgelu" else None)
    raise BadInputError(f'"{word}" is not an embedder', where="--embedder", choices=CHOICES)


def embed_views(embedder: Embedder, views: Sequence[ReferenceView]) -> NDArray[np.float64]:
    """Unit vectors (N, dim) of many views, in batches where the embedder can."""
    if isinstance(embedder, BatchEmbedder):
        return embedder.embed_batch(views)
    if not views:
        return np.zeros((0, embedder.dim))
    return np.stack([embedder.embed(view.rgb, view.mask, view.depth) for view in views])
