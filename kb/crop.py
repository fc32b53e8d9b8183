"""The picture of one object that a learnt embedder sees: the masked crop on a grey square (ledger G14g)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kb.errors import BadInputError

SIDE = 224
"""Side of the square that CLIP and EfficientNet-Lite0 take [px]."""
GREY = 128
"""What surrounds the object: the middle of the range, so that neither light nor dark things end in it."""
MARGIN = 0.08
"""Border around the object, as a share of the side."""


def masked_square(rgb: NDArray[np.uint8], mask: NDArray[np.bool_], side: int = SIDE) -> NDArray[np.uint8]:
    """The object alone on a grey square, as large as it fits; the aspect ratio is kept.

    Args:
        rgb: Colour image or crop (H, W, 3).
        mask: Pixels of the object (H, W).
        side: Side of the square [px].

    Returns:
        Picture (side, side, 3).

    Raises:
        BadInputError: if the mask is empty or of another shape than the picture.
    """
    from PIL import Image

    if rgb.shape[:2] != mask.shape or rgb.shape[2:] != (3,):
        raise BadInputError(f"picture {rgb.shape} and mask {mask.shape} do not fit together")
    rows, columns = np.nonzero(mask)
    if rows.size == 0:
        raise BadInputError("the mask is empty: there is nothing to embed")
    box = slice(int(rows.min()), int(rows.max()) + 1), slice(int(columns.min()), int(columns.max()) + 1)
    crop = np.where(mask[box][:, :, None], rgb[box], np.uint8(GREY)).astype(np.uint8)
    height, width = crop.shape[:2]
    edge = max(height, width) + 2 * max(1, round(MARGIN * max(height, width)))
    square = np.full((edge, edge, 3), GREY, np.uint8)
    top, left = (edge - height) // 2, (edge - width) // 2
    square[top : top + height, left : left + width] = crop
    picture = Image.fromarray(square).resize((side, side), Image.Resampling.BICUBIC)
    return np.asarray(picture, dtype=np.uint8)
