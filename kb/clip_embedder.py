"""CLIP ViT-L/14 through open_clip as visual embedder (Sec. III-A): weights by hub tag or from a local file.

Needs the extra `models`. Nothing is downloaded for a local file; a hub tag is fetched once by open_clip and then cached.
"""

from __future__ import annotations

import hashlib
import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kb.crop import masked_square
from kb.errors import BadInputError, EnvironmentFaultError
from kb.reference_views import ReferenceView

Array = NDArray[np.float64]

MODEL = "ViT-L-14"
DIM = 768
BATCH = 16
"""Pictures that go through the network at once."""
DEFAULT_TAG = "openai"
MEND = "install the extra: pip install 'agentic-rag-vlm[models]'"
FILES = (".safetensors", ".pt", ".pth", ".bin")
"""Endings that say that a file is meant and no tag."""
HEAD = 1 << 20
"""Bytes at either end of a weights file that its digest reads."""


class ClipEmbedder:
    """Embeds masked crops with the image tower of CLIP ViT-L/14."""

    def __init__(self, weights: str = DEFAULT_TAG, *, quick_gelu: bool | None = None) -> None:
        """Loads the model.

        Args:
            weights: A hub tag of open_clip ("openai", "laion2b_s32b_b82k", ...) or the path of a weights file.
            quick_gelu: Activation of the original weights; None: as the tag says, for a file no.

        Raises:
            BadInputError: neither a tag nor a file.
            EnvironmentFaultError: the extra is not installed, or the weights cannot be loaded or fetched.
        """
        file = Path(weights)
        if not file.is_file() and (file.suffix in FILES or len(file.parts) > 1):
            raise BadInputError(f"the weights file {weights} does not exist", where="--embedder")
        try:
            self._torch: Any = importlib.import_module("torch")
            open_clip: Any = importlib.import_module("open_clip")
        except ImportError as error:
            raise EnvironmentFaultError(f"the CLIP embedder cannot start: {error}", mend=MEND) from error
        tags: list[str] = list(open_clip.list_pretrained_tags_by_model(MODEL))
        self.is_published = weights in tags
        """Whether the weights are a published CLIP, named by its tag; a file may hold anything."""
        if not self.is_published and not file.is_file():
            raise BadInputError(f"{weights!r} is neither a file nor a tag of {MODEL}", where="--embedder", choices=tags)
        self._weights = weights if self.is_published else f"file-{digest_of(file)}"
        try:
            model, _, _ = open_clip.create_model_and_transforms(
                MODEL,
                pretrained=weights if self.is_published else str(file),
                force_quick_gelu=(weights == DEFAULT_TAG) if quick_gelu is None else quick_gelu,
            )
        except Exception as error:  # the loader's errors range from OSError to unpickling and shape errors
            what = f"CLIP weights {weights!r} cannot be loaded: {str(error).splitlines()[0][:200]}"
            mend = "give a local file: --embedder clip:/path/to/open_clip_model.safetensors"
            raise EnvironmentFaultError(what, mend=mend) from error
        self._model = model.eval()
        self._mean = np.asarray(open_clip.OPENAI_DATASET_MEAN, np.float32)
        self._std = np.asarray(open_clip.OPENAI_DATASET_STD, np.float32)

    @property
    def name(self) -> str:
        return f"clip-vit-l-14-{self._weights}"

    @property
    def dim(self) -> int:
        return DIM

    def embed(self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None) -> Array:
        """Embeds one object (see `kb.embedder.Embedder.embed`); depth is not used."""
        del depth
        return self._encode([masked_square(rgb, mask)])[0]

    def embed_batch(self, views: Sequence[ReferenceView]) -> Array:
        """Unit vectors (N, 768) of many views, in batches."""
        squares = [masked_square(view.rgb, view.mask) for view in views]
        parts = [self._encode(squares[start : start + BATCH]) for start in range(0, len(squares), BATCH)]
        return np.concatenate(parts) if parts else np.zeros((0, DIM))

    def _encode(self, squares: Sequence[NDArray[np.uint8]]) -> Array:
        pixels = (np.stack(squares).astype(np.float32) / 255.0 - self._mean) / self._std
        with self._torch.inference_mode():
            batch = self._torch.from_numpy(np.ascontiguousarray(pixels.transpose(0, 3, 1, 2)))
            vectors: Array = self._model.encode_image(batch).double().numpy()
        return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)


def digest_of(file: Path) -> str:
    """A short digest of a large file from its size and both ends: tells weights apart without reading a gigabyte."""
    size = file.stat().st_size
    digest = hashlib.sha256(str(size).encode())
    with file.open("rb") as stream:
        digest.update(stream.read(HEAD))
        stream.seek(max(0, size - HEAD))
        digest.update(stream.read(HEAD))
    return digest.hexdigest()[:12]
