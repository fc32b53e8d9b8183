"""What a visual embedder must offer, so that CLIP can stand where the compact descriptor stands (ledger A1.7, G14g)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from kb.reference_views import ReferenceView


@runtime_checkable
class Embedder(Protocol):
    """Turns the masked crop of one object into a unit vector."""

    @property
    def name(self) -> str:
        """Name with version; entries embedded under another name are not comparable."""
        ...

    @property
    def dim(self) -> int:
        """Length of the vectors."""
        ...

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None
    ) -> NDArray[np.float64]:
        """Embeds one object.

        Args:
            rgb: Colour image or crop, shape (H, W, 3).
            mask: Pixels of the object, shape (H, W); at least one.
            depth: Distance along the optical axis [m], shape (H, W), 0 where unmeasured; or None.

        Returns:
            Vector of Euclidean length 1, shape (dim,).
        """
        ...


@runtime_checkable
class BatchEmbedder(Embedder, Protocol):
    """An embedder that is faster with many objects at once."""

    def embed_batch(self, views: Sequence[ReferenceView]) -> NDArray[np.float64]:
        """Unit vectors (N, dim), the same as `embed` gives one by one up to rounding."""
        ...
