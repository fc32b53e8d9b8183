"""The core's visual embedder."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from kb.embedder import Embedder
from kb.errors import BadInputError
from kb.shape_colour import SHARES, ShapeColourEmbedder

EMBEDDER = ShapeColourEmbedder()


def picture(
    shape: str, colour: tuple[int, int, int], side: int = 80, shift: int = 0
) -> tuple[NDArray[np.uint8], NDArray[np.bool_], NDArray[np.float32]]:
    """A disc, bar or square of one colour in a grey picture, with a flat depth."""
    rows, columns = np.mgrid[: side * 2, : side * 2]
    y, x = rows - side - shift, columns - side + shift
    mask = {
        "disc": np.hypot(x, y) < side * 0.4,
        "square": (abs(x) < side * 0.35) & (abs(y) < side * 0.35),
        "bar": (abs(x) < side * 0.1) & (abs(y) < side * 0.45),
    }[shape]
    rgb = np.full((*mask.shape, 3), 128, dtype=np.uint8)
    rgb[mask] = colour
    return rgb, mask, np.where(mask, 0.8, 1.2).astype(np.float32)


def similarity(one: tuple[object, ...], other: tuple[object, ...]) -> float:
    return float(EMBEDDER.embed(*one) @ EMBEDDER.embed(*other))  # type: ignore[arg-type]


def test_it_is_an_embedder_and_the_shares_sum_to_one() -> None:
    """It fulfils the protocol, and colour's share of the squared length is a quarter."""
    assert isinstance(EMBEDDER, Embedder)
    assert sum(SHARES.values()) == pytest.approx(1.0)
    assert SHARES["colour"] == 0.25


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), height=st.integers(1, 60), width=st.integers(1, 60), filled=st.floats(0.01, 1.0))
def test_vectors_are_unit_non_negative_and_deterministic(seed: int, height: int, width: int, filled: float) -> None:
    """For any picture and mask: length 1, no negative number, and the same answer twice."""
    rng = np.random.default_rng(seed)
    rgb = rng.integers(0, 256, (height, width, 3), dtype=np.uint8)
    mask = rng.random((height, width)) < filled
    mask[rng.integers(height), rng.integers(width)] = True
    depth = rng.random((height, width)).astype(np.float32)
    vector = EMBEDDER.embed(rgb, mask, depth)
    assert vector.shape == (EMBEDDER.dim,)
    assert np.linalg.norm(vector) == pytest.approx(1.0)
    assert vector.min() >= 0.0
    assert np.array_equal(vector, EMBEDDER.embed(rgb, mask, depth))


def test_place_and_distance_of_the_object_hardly_matter() -> None:
    """The same disc elsewhere in the picture is the same; at 1.5 times the size the cosine stays above 0.99."""
    disc = picture("disc", (200, 30, 30))
    assert similarity(disc, picture("disc", (200, 30, 30), shift=9)) == pytest.approx(1.0)
    assert similarity(disc, picture("disc", (200, 30, 30), side=120)) > 0.99


def test_shape_counts_more_than_colour() -> None:
    """A disc is nearer to a disc of another colour than to a bar of the same colour."""
    red_disc = picture("disc", (200, 30, 30))
    assert similarity(red_disc, picture("disc", (30, 30, 200))) > similarity(red_disc, picture("bar", (200, 30, 30)))


def test_colour_counts() -> None:
    """Of two discs the one of the same colour is nearer."""
    red_disc = picture("disc", (200, 30, 30))
    assert similarity(red_disc, picture("disc", (180, 40, 35))) > similarity(red_disc, picture("disc", (30, 30, 200)))


def test_an_empty_mask_is_refused() -> None:
    """There is nothing to embed."""
    rgb, mask, depth = picture("disc", (1, 2, 3))
    with pytest.raises(BadInputError, match="empty"):
        EMBEDDER.embed(rgb, np.zeros_like(mask), depth)


def test_pictures_that_do_not_fit_are_refused() -> None:
    """The message names the shapes."""
    rgb, mask, _ = picture("disc", (1, 2, 3))
    with pytest.raises(BadInputError, match="do not fit"):
        EMBEDDER.embed(rgb[:-1], mask, None)


def test_it_takes_less_than_three_milliseconds_of_processor_time() -> None:
    """A crop of 112 x 112 pixels is embedded in under 3 ms (median of 20, processor time)."""
    args = picture("square", (90, 160, 40), side=56)
    times = []
    for _ in range(20):
        start = time.process_time()
        EMBEDDER.embed(*args)
        times.append(time.process_time() - start)
    assert np.median(times) < 0.003
