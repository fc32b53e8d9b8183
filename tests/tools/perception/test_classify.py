"""Laws of the classifier on the shipped references."""

from __future__ import annotations

import numpy as np
import pytest

from kb.references import load_references
from tools.perception.classify import STRANGE_COLOUR, classify, colour_evidence
from tools.perception.colour import colour_name
from tools.perception.features import FEATURES


def test_references_fit_the_features() -> None:
    """The shipped statistics speak of exactly the features that are measured."""
    references = load_references()
    assert references.features == FEATURES
    assert references.mean.shape == (len(references.categories), len(FEATURES))


@pytest.mark.parametrize("name", load_references().categories)
def test_every_category_is_recognised_at_its_own_mean(name: str) -> None:
    """At its own mean each category is the most probable one, is known, and the posterior sums to 1."""
    references = load_references()
    k = references.categories.index(name)
    judged = classify(references.mean[k], references.colour_mean[k], references)
    assert judged.category == name
    assert judged.posterior["unknown"] < 0.5
    assert sum(judged.posterior.values()) == pytest.approx(1.0)


def test_what_is_far_from_everything_is_unknown() -> None:
    """Features ten standard deviations off are unknown, and that is said with confidence."""
    references = load_references()
    spread = references.mean.std(0) + 0.05
    judged = classify(references.mean[0] + 10 * spread, references.colour_mean[0], references)
    assert judged.category == "unknown"
    assert judged.confidence > 0.9


def test_a_colour_that_fits_nothing_of_that_shape_says_nothing() -> None:
    """A dark blue ball is neither an apple nor a tennis ball for its colour: no category gains by being the less strange one,
    while the colour of an apple still counts for apples."""
    references = load_references()
    apple, ball = (references.categories.index(name) for name in ("apple", "tennis_ball"))
    score = np.full(len(references.categories), -100.0)
    score[[apple, ball]] = 0.0
    blue = np.array([0.10, 0.15, -0.5])
    offset = blue - references.colour_mean
    square = np.einsum("ci,cij,cj->c", offset, references.colour_precision, offset)
    assert square[[apple, ball]].min() > STRANGE_COLOUR
    assert not colour_evidence(blue, references, score).any()
    green = colour_evidence(references.colour_mean[apple], references, score)
    assert green[apple] != 0.0


def test_a_noun_tips_even_scales_only() -> None:
    """A noun makes its category more probable where two are alike, and changes nothing where one is certain."""
    references = load_references()
    i, j = references.categories.index("block"), references.categories.index("cube")
    middle = (references.mean[i] + references.mean[j]) / 2
    colour = (references.colour_mean[i] + references.colour_mean[j]) / 2
    plain = classify(middle, colour, references)
    hinted = classify(middle, colour, references, ("cube",))
    assert hinted.posterior.get("cube", 0.0) >= plain.posterior.get("cube", 0.0)
    sure = classify(references.mean[i], references.colour_mean[i], references, ("banana",))
    assert sure.category == "block"


@pytest.mark.parametrize(
    ("rgb", "name"),
    [
        ((0.8, 0.1, 0.1), "red"),
        ((0.9, 0.85, 0.2), "yellow"),
        ((0.2, 0.6, 0.2), "green"),
        ((0.15, 0.25, 0.8), "blue"),
        ((0.05, 0.05, 0.06), "black"),
        ((0.9, 0.9, 0.88), "white"),
        ((0.45, 0.45, 0.45), "grey"),
        ((0.5, 0.32, 0.18), "brown"),
    ],
)
def test_colours_have_their_everyday_names(rgb: tuple[float, float, float], name: str) -> None:
    """Named colours carry the names that people give them."""
    assert colour_name(rgb) == name


def test_names_of_colours_do_not_depend_on_hue_noise_of_greys() -> None:
    """Greys with 2 % of colour noise stay black, grey or white."""
    rng = np.random.default_rng(0)
    for value in (0.08, 0.4, 0.9):
        noisy = np.clip(value + 0.01 * rng.standard_normal(3), 0, 1)
        assert colour_name((float(noisy[0]), float(noisy[1]), float(noisy[2]))) in ("black", "grey", "white")
