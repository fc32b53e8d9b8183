"""The learnt visual embedders, run for real: EfficientNet-Lite0 with its own weights, ViT-L/14 with random ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kb.embed_store import embedded_store
from kb.embedder import BatchEmbedder
from kb.errors import BadInputError, EnvironmentFaultError
from kb.open_embedder import embed_views, open_embedder
from kb.reference_views import ReferenceView, load_views, views_path
from kb.store import ExperienceStore

pytestmark = pytest.mark.models


@pytest.fixture(scope="module")
def views() -> list[ReferenceView]:
    """The first five reference views of the shipped knowledge base."""
    path = ExperienceStore.open().path
    assert path is not None
    return list(load_views(views_path(path)).values())[:5]


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ViT-L/14 with random weights in a local safetensors file (1.7 GB)."""
    open_clip: Any = pytest.importorskip("open_clip")
    torch: Any = pytest.importorskip("torch")
    save: Any = pytest.importorskip("safetensors.torch")
    torch.manual_seed(0)
    model = open_clip.create_model("ViT-L-14", pretrained=None)
    path = tmp_path_factory.mktemp("weights") / "vit_l_14.safetensors"
    save.save_file({name: value.contiguous() for name, value in model.state_dict().items()}, str(path))
    return path


def _is_sound(embedder: Any, views: list[ReferenceView], dim: int) -> None:
    together, again = embed_views(embedder, views), embed_views(embedder, views)
    alone = np.stack([embedder.embed(view.rgb, view.mask, view.depth) for view in views])
    assert isinstance(embedder, BatchEmbedder)
    assert together.shape == (len(views), dim)
    assert embedder.dim == dim
    np.testing.assert_allclose(np.linalg.norm(together, axis=1), 1.0, atol=1e-9)
    np.testing.assert_array_equal(together, again)
    np.testing.assert_allclose(together, alone, atol=1e-5)
    assert len({tuple(row) for row in together.round(4).tolist()}) == len(views)


def test_clip_from_a_local_file(weights: Path, views: list[ReferenceView]) -> None:
    """ViT-L/14 from a file: 768 numbers of length 1, batch = one by one, twice the same, not called a published CLIP."""
    embedder: Any = open_embedder(f"clip:{weights}")
    _is_sound(embedder, views, 768)
    assert embedder.name.startswith("clip-vit-l-14-file-")
    assert not embedder.is_published


def test_clip_refuses_what_is_no_weights_file(tmp_path: Path) -> None:
    """A damaged file ends in one line with the mend, an unknown tag in one line with the choices."""
    broken = tmp_path / "broken.safetensors"
    broken.write_bytes(b"not weights at all")
    with pytest.raises(EnvironmentFaultError, match="cannot be loaded"):
        open_embedder(f"clip:{broken}")
    with pytest.raises(BadInputError, match="neither a file nor a tag"):
        open_embedder("clip:no_such_tag")


def test_efficientnet_has_its_weights_with_it(views: list[ReferenceView]) -> None:
    """EfficientNet-Lite0 works without network: 1280 numbers of length 1, deterministic, the same in batches."""
    _is_sound(open_embedder("efficientnet"), views, 1280)


def test_the_knowledge_base_is_embedded_anew_and_cached(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Embedded by EfficientNet, the nearest other entry is of the same category in at least 85 % of the 116 cases;
    the vectors come from the cache the second time."""
    monkeypatch.setenv("RAGVLM_CACHE", str(tmp_path))
    embedder = open_embedder("efficientnet")
    store = embedded_store(ExperienceStore.open(), embedder)
    vectors = np.array([entry.embedding for entry in store.all()])
    alike = vectors @ vectors.T - 2 * np.eye(len(vectors))
    kinds = np.array([entry.category for entry in store.all()])
    assert float(np.mean(kinds == kinds[alike.argmax(axis=1)])) >= 0.85
    monkeypatch.setattr(embedder, "embed_batch", None)
    assert embedded_store(ExperienceStore.open(), embedder).all() == store.all()
    with pytest.raises(EnvironmentFaultError, match="embedded with 'efficientnet-lite0-1'"):
        store.require_embedder("shape-colour-1")
