"""The stored pictures of the knowledge base and embedding it anew from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from kb.crop import GREY, masked_square
from kb.embed_store import embedded_store
from kb.errors import EnvironmentFaultError
from kb.reference_views import ReferenceView, load_views, save_views, view_key, views_path
from kb.shape_colour import ShapeColourEmbedder
from kb.store import ExperienceStore


class MeanColour:
    """A three-number embedder."""

    name = "mean-colour"
    dim = 3
    calls = 0

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None
    ) -> NDArray[np.float64]:
        """Mean colour of the object's pixels as a unit vector."""
        self.calls += 1
        mean = rgb[mask].mean(axis=0) + 1.0
        return mean / np.linalg.norm(mean)


def test_every_shipped_entry_has_the_picture_it_was_embedded_from() -> None:
    """The core's embedder gives each of the 116 stored pictures the embedding of its entry (cosine above 0.9999)."""
    store, embedder = ExperienceStore.open(), ShapeColourEmbedder()
    assert store.path is not None
    views = load_views(views_path(store.path))
    for entry in store.all():
        view = views[view_key(entry)]
        again = embedder.embed(view.rgb, view.mask, view.depth)
        assert float(again @ np.asarray(entry.embedding)) > 0.9999


def test_views_survive_a_file(tmp_path: Path) -> None:
    """Saved and loaded, pictures and masks are the same, depths to a tenth of a millimetre; the bytes are repeatable."""
    rng = np.random.default_rng(0)
    views: dict[str, ReferenceView] = {}
    for i in range(3):
        mask = rng.random((5 + i, 7)) < 0.6
        rgb = np.where(mask[:, :, None], rng.integers(0, 255, (*mask.shape, 3)), 0).astype(np.uint8)
        views[f"e{i}@0"] = ReferenceView(rgb, mask, np.where(mask, rng.random(mask.shape), 0).astype(np.float32))
    save_views(tmp_path / "a.npz", views)
    save_views(tmp_path / "b.npz", views)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    for key, view in load_views(tmp_path / "a.npz").items():
        np.testing.assert_array_equal(view.rgb, views[key].rgb)
        np.testing.assert_array_equal(view.mask, views[key].mask)
        np.testing.assert_allclose(view.depth, views[key].depth, atol=6e-5)


def test_another_embedder_embeds_the_stored_pictures_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The store comes back with the other embedder's name and vectors; the second time they come from the cache."""
    monkeypatch.setenv("RAGVLM_CACHE", str(tmp_path))
    embedder = MeanColour()
    store = embedded_store(ExperienceStore.open(), embedder)
    assert (store.embedder_name, store.header.dim, len(store), embedder.calls) == ("mean-colour", 3, 116, 116)
    assert embedded_store(ExperienceStore.open(), embedder).all() == store.all()
    assert embedder.calls == 116
    with pytest.raises(EnvironmentFaultError, match="mean-colour"):
        store.require_embedder(ShapeColourEmbedder().name)


def test_without_pictures_another_embedder_is_refused(tmp_path: Path) -> None:
    """A knowledge base without reference views, or with those of another, is refused in one line with the mend."""
    copy = tmp_path / "kb.jsonl"
    ExperienceStore.open().save(copy)
    with pytest.raises(EnvironmentFaultError, match=r"no reference views.*ragvlm kb views"):
        embedded_store(ExperienceStore.open(copy), MeanColour())
    view = ReferenceView(np.zeros((1, 1, 3), np.uint8), np.ones((1, 1), bool), np.zeros((1, 1), np.float32))
    save_views(views_path(copy), {"cup-01@99999": view})
    with pytest.raises(EnvironmentFaultError, match="116 reference views are missing"):
        embedded_store(ExperienceStore.open(copy), MeanColour())
    views_path(copy).write_bytes(b"rubbish")
    with pytest.raises(EnvironmentFaultError, match="damaged"):
        embedded_store(ExperienceStore.open(copy), MeanColour())


def test_the_crop_keeps_the_aspect_and_blanks_what_is_no_object() -> None:
    """A 10 x 40 object stays four times as wide as high on the square, and everything around it is grey."""
    rgb = np.full((60, 60, 3), 255, np.uint8)
    mask = np.zeros((60, 60), bool)
    mask[20:30, 10:50] = True
    square = masked_square(rgb, mask)
    bright = (square > 200).all(axis=2)
    rows, columns = np.flatnonzero(bright.any(axis=-1)), np.flatnonzero(bright.any(axis=0))
    assert np.ptp(columns) / np.ptp(rows) == pytest.approx(4.0, rel=0.05)
    assert square[0, 0].tolist() == [GREY] * 3
