"""Which category an object belongs to, how sure that is, and whether it belongs to none.

A Gaussian per category over geometry, and colour with a small weight. Whether any category fits is judged by the
distance to the nearest one, not by how much better it fits than the others (soft-max confidence is useless there:
AUROC 0.71, perception.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.references import References
from kb.vocabulary import UNKNOWN_CATEGORY

Array = NDArray[np.float64]

NOUN_FACTOR = 3.0
"""How much more probable a category becomes because the instruction speaks of it: enough to tip even scales."""

UNFIT = 0.01
"""A category whose shape is this many times less probable than the best one's is not considered."""
STRANGE_COLOUR = 16.3
"""Squared Mahalanobis distance that one colour in a thousand of a category exceeds (chi squared, three degrees)."""


@dataclass(frozen=True)
class Judgement:
    """What the classifier says about one object."""

    category: str
    confidence: float
    posterior: dict[str, float]
    """Per category and for "unknown"; sums to 1."""
    distance: float
    """Log of the smallest Mahalanobis distance per feature: how far from everything known."""


def classify(
    geometry: Array, colour: Array, references: References, nouns: tuple[str, ...] = (), noise: float = 1.0
) -> Judgement:
    """Judges one object by its geometric (F,) and colour (3,) features.

    A picture with `noise` times the ordinary noise spreads what is measured that much more about each category.
    """
    square, log_likelihood = (value / noise**2 for value in distances(geometry, references))
    log_colour = colour_evidence(colour, references, log_likelihood / references.temperature)
    score = (log_likelihood + references.colour_weight * log_colour) / references.temperature
    score = score + np.log(NOUN_FACTOR) * np.array([name in nouns for name in references.categories])
    share = np.exp(score - score.max())
    share /= share.sum()
    distance = novelty(square, len(geometry))
    unknown = 1.0 / (1.0 + np.exp(-np.clip(references.unknown_slope * (distance - references.unknown_offset), -40, 40)))
    posterior = {
        name: float((1 - unknown) * p) for name, p in zip(references.categories, share, strict=True) if p > 1e-4
    }
    posterior[UNKNOWN_CATEGORY] = float(unknown)
    total = sum(posterior.values())
    posterior = {name: p / total for name, p in posterior.items()}
    if unknown > 0.5:
        return Judgement(UNKNOWN_CATEGORY, posterior[UNKNOWN_CATEGORY], posterior, distance)
    best = max((name for name in posterior if name != UNKNOWN_CATEGORY), key=lambda name: posterior[name])
    return Judgement(best, posterior[best], posterior, distance)


def distances(geometry: Array, references: References) -> tuple[Array, Array]:
    """Squared Mahalanobis distance and Gaussian log likelihood (up to a constant) to each category, both (C,)."""
    offset = geometry - references.mean
    square = np.einsum("ci,cij,cj->c", offset, references.precision, offset)
    return square, -0.5 * (square + references.log_det)


def colour_log_likelihood(colour: Array, references: References) -> Array:
    """Gaussian log likelihood of a colour (3,) under each category (C,), up to a constant."""
    offset = colour - references.colour_mean
    square = np.einsum("ci,cij,cj->c", offset, references.colour_precision, offset)
    return -0.5 * (square + references.colour_log_det)


def colour_evidence(colour: Array, references: References, score: Array) -> Array:
    """`colour_log_likelihood`, or nothing where the colour is strange for every category that the shape fits.

    Which of two implausible colours is the less implausible says nothing: a brown ball is no apple for not being yellow.
    """
    fits = score > score.max() + np.log(UNFIT)
    offset = colour - references.colour_mean
    square = np.einsum("ci,cij,cj->c", offset, references.colour_precision, offset)
    if float(square[fits].min()) > STRANGE_COLOUR:
        return np.zeros(len(square))
    return colour_log_likelihood(colour, references)


def novelty(square: Array, count: int) -> float:
    """Log of the smallest squared distance (C,) per feature."""
    return float(np.log(max(float(square.min()), 1e-6) / count))
