"""Reference statistics of the known categories: what their measurements look like in rendered reference views.

Made by `python -m bench.make_references` from catalogue renderings (seeds 0-9999) and shipped as data. They tell
categories apart; no size or position is ever taken from them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from kb.errors import EnvironmentFaultError

Array = NDArray[np.float64]

FILE = "references.npz"


@dataclass(frozen=True)
class References:
    """One Gaussian per category over geometric features, one over colour, and the calibration of both."""

    categories: tuple[str, ...]
    features: tuple[str, ...]
    """Names of the geometric features, in order (F of them)."""
    mean: Array
    """(C, F)."""
    precision: Array
    """Inverse shrunk covariances (C, F, F)."""
    log_det: Array
    """Log determinants of the covariances (C,)."""
    colour_mean: Array
    """(C, 3)."""
    colour_precision: Array
    """(C, 3, 3)."""
    colour_log_det: Array
    """(C,)."""
    colour_weight: float
    """Exponent of the colour likelihood: colour counts only as far as it tells categories apart on reference views."""
    temperature: float
    """Divisor of the log likelihoods that makes the posterior honest on held-out reference views."""
    unknown_offset: float
    unknown_slope: float
    """P(no category fits) = sigmoid(slope (log distance - offset)), fitted on reference views and random shapes."""


@cache
def load_references() -> References:
    """The shipped statistics.

    Raises:
        EnvironmentFaultError: if the data file is missing.
    """
    path = resources.files("kb").joinpath("data", FILE)
    if not path.is_file():
        raise EnvironmentFaultError(f"kb/data/{FILE} is missing", mend="run `python -m bench.make_references`")
    with path.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
        return References(
            categories=tuple(str(name) for name in data["categories"]),
            features=tuple(str(name) for name in data["features"]),
            mean=data["mean"].astype(np.float64),
            precision=data["precision"].astype(np.float64),
            log_det=data["log_det"].astype(np.float64),
            colour_mean=data["colour_mean"].astype(np.float64),
            colour_precision=data["colour_precision"].astype(np.float64),
            colour_log_det=data["colour_log_det"].astype(np.float64),
            colour_weight=float(data["colour_weight"]),
            temperature=float(data["temperature"]),
            unknown_offset=float(data["unknown_offset"]),
            unknown_slope=float(data["unknown_slope"]),
        )
