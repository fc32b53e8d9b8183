"""The measurement of perception: its statistics, and one scene through it."""

from __future__ import annotations

import numpy as np
import pytest

from bench.make_references import calibrate_unknown, fit_references
from bench.perception_numbers import TARGETS, auroc, calibration_error, markdown, summarise
from bench.perception_report import run_scene
from kb.references import load_references


def test_auroc_is_the_chance_to_rank_rightly() -> None:
    """1 for separated scores, 0.5 for equal ones, and the share of right pairs in between."""
    assert auroc([0.9, 0.8], [0.1, 0.2]) == 1.0
    assert auroc([0.5], [0.5]) == 0.5
    assert auroc([0.9, 0.1], [0.5]) == 0.5


def test_calibration_error_is_the_gap_between_words_and_deeds() -> None:
    """Confidence 0.8 that is right four times out of five is calibrated; right once out of five it is off by 0.6."""
    assert calibration_error([0.8] * 5, [True] * 4 + [False]) == pytest.approx(0.0)
    assert calibration_error([0.8] * 5, [True] + [False] * 4) == pytest.approx(0.6)


def test_one_scene_gives_every_promised_number() -> None:
    """A scene of one object yields each measure that has a target, and the table names them all."""
    result = run_scene(10000)
    assert [row["found"] for row in result.rows] == [True] * len(result.rows)
    summary = summarise([result])
    assert set(TARGETS) <= set(summary)
    table = markdown(summary, 10000)
    assert all(name.replace("_", " ") in table for name in TARGETS)


def test_references_are_fitted_to_what_they_are_given() -> None:
    """Means are those of the samples, and far samples are told from near ones by the calibrated distance."""
    rng = np.random.default_rng(0)
    count = len(load_references().features)
    centres = {"cup": np.zeros(count), "bowl": np.full(count, 3.0)}
    label = np.array([name for name in centres for _ in range(40)] + ["unknown"] * 40)
    geometry = np.concatenate([centre + rng.normal(size=(40, count)) for centre in centres.values()])
    geometry = np.concatenate([geometry, rng.normal(size=(40, count)) * 3 + 10])
    fitted = fit_references(label, geometry, rng.normal(size=(120, 3)))
    assert fitted["categories"].tolist() == ["bowl", "cup"]
    np.testing.assert_allclose(fitted["mean"][1], geometry[:40].mean(0), atol=1e-5)
    offset, slope = calibrate_unknown(np.array([-1.0, 0.0, 0.5]), np.array([3.0, 4.0]))
    assert 0.5 <= offset <= 3.0
    assert slope > 0
