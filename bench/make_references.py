"""Make the reference statistics of perception from rendered catalogue objects: `python -m bench.make_references`.

Uses seeds 0-9999 only (knowledge-base range). Each sample is one catalogue object, or one shape from outside the
catalogue, alone on the table in random pose, size, colour and light, seen with the usual noise. The result is
`kb/data/references.npz`; the same seeds give the same bytes.
"""

from __future__ import annotations

import argparse
import logging
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.reference_views import MODELS_SEEN, random_shape_view, reference_view
from kb.references import FILE
from tools.perception.classify import novelty
from tools.perception.features import FEATURES, colour_features, features
from tools.perception.look import measure_alone

Array = NDArray[np.float64]
log = logging.getLogger(__name__)

PER_MODEL, RANDOM_SHAPES = 60, 240
"""Reference views per catalogue object, and random shapes for the calibration of "unknown"."""

OWN_SHARE = 0.5
"""Weight of a category's own covariance against the pooled one: 60 views do not fix 400 numbers."""

FLOOR = 0.10
"""Standard deviation that every feature has at least, as a share of its pooled one."""


def sample(job: tuple[str, int]) -> tuple[str, Array, Array] | None:
    """Category, geometric and colour features of one reference view; None if nothing was segmented."""
    name, seed = job
    category, views = random_shape_view(seed) if name == "random" else reference_view(name, seed)
    measured = measure_alone(views)
    return None if measured is None else (category, features(measured), colour_features(measured))


def main() -> None:
    """Renders, measures, fits, calibrates, writes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--per-model", type=int, default=PER_MODEL)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "kb" / "data" / FILE)
    parser.add_argument("--samples", type=Path, default=None, help="also keep the raw features here")
    options = parser.parse_args()
    jobs = [(name, 100 * i + k) for i, name in enumerate(MODELS_SEEN) for k in range(options.per_model)]
    shapes = RANDOM_SHAPES * options.per_model // PER_MODEL
    jobs += [("random", 5000 + k) for k in range(shapes)]
    with ProcessPoolExecutor(options.jobs) as pool:
        rows = [row for row in pool.map(sample, jobs, chunksize=8) if row is not None]
    log.info("%d of %d views measured", len(rows), len(jobs))
    label = np.array([row[0] for row in rows])
    geometry, colour = np.stack([row[1] for row in rows]), np.stack([row[2] for row in rows])
    if options.samples is not None:
        np.savez_compressed(options.samples, label=label, geometry=geometry, colour=colour)
    np.savez_compressed(options.out, **fit_references(label, geometry, colour))


def fit_references(label: NDArray[np.str_], geometry: Array, colour: Array) -> dict[str, Any]:
    """The arrays of `kb.references.References` from labelled features (N,), (N, F), (N, 3); label "unknown" is novel."""
    known = label != "unknown"
    categories = sorted(set(label[known].tolist()))
    truth = np.array([categories.index(name) for name in label[known]])
    g, c = geometry[known], colour[known]
    fold = np.arange(len(truth)) // 2 % 2  # filled and empty views alternate, and both belong in both halves
    held = np.empty((len(truth), len(categories)))
    held_colour, square = np.empty_like(held), np.empty_like(held)
    for part in (0, 1):
        train, test = fold != part, fold == part
        model = gaussians(g[train], truth[train], len(categories))
        hue = gaussians(c[train], truth[train], len(categories), own=1.0)
        square[test], held[test] = log_likelihoods(g[test], model)
        held_colour[test] = log_likelihoods(c[test], hue)[1]
    weight, temperature = calibrate_posterior(held, held_colour, truth)
    model, hue = gaussians(g, truth, len(categories)), gaussians(c, truth, len(categories), own=1.0)
    outside = log_likelihoods(geometry[~known], model)[0]
    inside_distance = np.array([novelty(row, len(FEATURES)) for row in square])
    outside_distance = np.array([novelty(row, len(FEATURES)) for row in outside])
    offset, slope = calibrate_unknown(inside_distance, outside_distance)
    right = np.mean((held + weight * held_colour).argmax(1) == truth)
    log.info("held-out accuracy %.3f, colour weight %.2f, temperature %.1f", right, weight, temperature)
    log.info("known %s", np.quantile(inside_distance, [0.5, 0.9, 0.97, 0.99]).round(2))
    log.info("outside %s", np.quantile(outside_distance, [0.03, 0.1, 0.5]).round(2))
    return {
        "categories": np.array(categories),
        "features": np.array(FEATURES),
        "mean": model[0].astype(np.float32),
        "precision": model[1].astype(np.float32),
        "log_det": model[2].astype(np.float32),
        "colour_mean": hue[0].astype(np.float32),
        "colour_precision": hue[1].astype(np.float32),
        "colour_log_det": hue[2].astype(np.float32),
        "colour_weight": np.float64(weight),
        "temperature": np.float64(temperature),
        "unknown_offset": np.float64(offset),
        "unknown_slope": np.float64(slope),
    }


def gaussians(x: Array, truth: NDArray[np.intp], count: int, own: float = OWN_SHARE) -> tuple[Array, Array, Array]:
    """Means (C, F), inverse covariances (C, F, F) and log determinants (C,), shrunk towards the pooled covariance."""
    means = np.stack([x[truth == k].mean(0) for k in range(count)])
    centred = x - means[truth]
    pooled = centred.T @ centred / len(x)
    floor = np.diag((FLOOR**2) * pooled.diagonal() + 1e-6)
    precisions, log_dets = [], []
    for k in range(count):
        mine = centred[truth == k]
        covariance = own * (mine.T @ mine / len(mine)) + (1 - own) * np.diag(pooled.diagonal()) * 0.5 + floor
        precisions.append(np.linalg.inv(covariance))
        log_dets.append(np.linalg.slogdet(covariance)[1])
    return means, np.stack(precisions), np.array(log_dets)


def log_likelihoods(x: Array, model: tuple[Array, Array, Array]) -> tuple[Array, Array]:
    """Squared distances and log likelihoods, both (N, C), of samples (N, F)."""
    offset = x[:, None] - model[0]
    square = np.einsum("nci,cij,ncj->nc", offset, model[1], offset)
    return square, -0.5 * (square + model[2])


def calibrate_posterior(held: Array, colour: Array, truth: NDArray[np.intp]) -> tuple[float, float]:
    """Colour weight and temperature of least cross-entropy on held-out views, over a grid."""
    best = (np.inf, 0.0, 1.0)
    for weight in (0.0, 0.1, 0.2, 0.3, 0.5):
        for temperature in (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0):
            score = (held + weight * colour) / temperature
            log_share = score - score.max(1, keepdims=True)
            log_share -= np.log(np.exp(log_share).sum(1, keepdims=True))
            loss = -float(np.mean(log_share[np.arange(len(truth)), truth]))
            best = min(best, (loss, weight, temperature))
    return best[1], best[2]


def calibrate_unknown(inside: Array, outside: Array) -> tuple[float, float]:
    """Offset and slope of the logistic that separates known (N,) from outside (M,) distances, classes weighted evenly."""
    x = np.concatenate([inside, outside])
    y = np.concatenate([np.zeros(len(inside)), np.ones(len(outside))])
    w = np.concatenate([np.full(len(inside), 0.7 / len(inside)), np.full(len(outside), 0.3 / len(outside))])
    best = (np.inf, 0.0, 1.0)
    for offset in np.linspace(x.min(), x.max(), 80):
        for slope in (0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0):
            p = np.clip(1 / (1 + np.exp(-np.clip(slope * (x - offset), -40, 40))), 1e-4, 1 - 1e-4)
            loss = -float(w @ (y * np.log(p) + (1 - y) * np.log(1 - p)))
            best = min(best, (loss, float(offset), slope))
    return best[1], best[2]


if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    main()
