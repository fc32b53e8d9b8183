"""The reference views of the knowledge base: the masked crop that each entry's embedding was made from.

They are stored beside the knowledge base, so that any embedder can embed its entries anew. A view belongs to an entry by
its id and the first seed of its trials: a rebuilt knowledge base does not silently keep the pictures of the old one.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kb.errors import EnvironmentFaultError
from kb.experience import Experience

DEPTH_STEP = 1e-4
"""Stored depths are whole multiples of this [m]: a tenth of the sensor's noise."""
MEND = "make the pictures again with `ragvlm kb views`"


@dataclass(frozen=True)
class ReferenceView:
    """One object as the front camera saw it; pixels off the object are zero."""

    rgb: NDArray[np.uint8]
    """(H, W, 3)."""
    mask: NDArray[np.bool_]
    """(H, W), at least one pixel."""
    depth: NDArray[np.float32]
    """Along the optical axis [m] (H, W), 0 where unmeasured."""


def cropped(rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None) -> ReferenceView:
    """The smallest crop that holds the mask, with everything else blank."""
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    box = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)
    inside = mask[box]
    kept = np.zeros(inside.shape, np.float32) if depth is None else np.where(inside, depth[box], 0.0)
    return ReferenceView(
        np.where(inside[:, :, None], rgb[box], np.uint8(0)).astype(np.uint8), inside, kept.astype(np.float32)
    )


def view_key(entry: Experience) -> str:
    """What a view belongs to."""
    return f"{entry.id}@{entry.seeds[0]}"


def views_path(store: Path) -> Path:
    """Where the views of a knowledge base file are: `x.jsonl` has `x.views.npz`."""
    return store.with_suffix(".views.npz")


def save_views(path: Path, views: Mapping[str, ReferenceView]) -> None:
    """Writes all views into one compressed file; the same views give the same bytes."""
    keys = sorted(views)
    shapes = np.array([views[key].mask.shape for key in keys], np.int32).reshape(-1, 2)

    def flat(parts: Sequence[NDArray[np.generic]], kind: type[np.generic]) -> NDArray[np.generic]:
        return np.concatenate([part.ravel() for part in parts]).astype(kind) if parts else np.zeros(0, kind)

    depths = [np.round(views[key].depth / DEPTH_STEP) for key in keys]
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        keys=np.array(keys, dtype=np.str_),
        shapes=shapes,
        rgb=flat([views[key].rgb for key in keys], np.uint8),
        mask=np.packbits(flat([views[key].mask for key in keys], np.bool_).astype(np.uint8)),
        depth=flat(depths, np.uint16),
    )
    try:
        path.write_bytes(buffer.getvalue())
    except OSError as error:
        raise EnvironmentFaultError(
            f"cannot write the reference views {path}: {error.strerror}", mend="give a path that can be written"
        ) from error


def load_views(path: Path) -> dict[str, ReferenceView]:
    """All views of a file by key.

    Raises:
        EnvironmentFaultError: if there is no such file or it is damaged.
    """
    if not path.is_file():
        raise EnvironmentFaultError(f"the reference views {path} are missing", mend=MEND)
    try:
        with np.load(path, allow_pickle=False) as data:
            return _unpacked(data["keys"], data["shapes"], data["rgb"], data["mask"], data["depth"])
    except Exception as error:  # zip, zlib and numpy each have their own errors for a damaged file
        raise EnvironmentFaultError(f"the reference views {path} are damaged: {error}", mend=MEND) from error


def _unpacked(
    keys: NDArray[np.str_],
    shapes: NDArray[np.int32],
    rgb: NDArray[np.uint8],
    packed: NDArray[np.uint8],
    depth: NDArray[np.uint16],
) -> dict[str, ReferenceView]:
    ends = np.cumsum(shapes.prod(axis=1))
    mask = np.unpackbits(packed)[: int(ends[-1]) if len(ends) else 0].astype(bool)
    views: dict[str, ReferenceView] = {}
    for key, shape, end in zip(keys.tolist(), shapes.tolist(), ends.tolist(), strict=True):
        start = end - shape[0] * shape[1]
        views[str(key)] = ReferenceView(
            rgb[3 * start : 3 * end].reshape(*shape, 3),
            mask[start:end].reshape(shape),
            (depth[start:end].reshape(shape) * np.float32(DEPTH_STEP)).astype(np.float32),
        )
    return views


def views_digest(views: Sequence[ReferenceView]) -> str:
    """Digest of the pictures, in order: the same pictures always have the same."""
    digest = hashlib.sha256()
    for view in views:
        digest.update(view.rgb.tobytes() + view.mask.tobytes() + str(view.mask.shape).encode())
        digest.update(np.round(view.depth / DEPTH_STEP).astype(np.uint16).tobytes())
    return digest.hexdigest()[:16]
