"""Connected components of a graph with numpy alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.intp]


def connected(count: int, first: Index, second: Index) -> Index:
    """Component number (count,), from 0 in order of the smallest member, of nodes joined by edges `first`-`second`.

    Labels sink to the smallest of their neighbours and then jump to their label's label, until nothing changes.
    """
    label = np.arange(count)
    while True:
        low = np.minimum(label[first], label[second])
        sunk = label.copy()
        np.minimum.at(sunk, label[first], low)
        np.minimum.at(sunk, label[second], low)
        while True:
            jumped = sunk[sunk]
            if np.array_equal(jumped, sunk):
                break
            sunk = jumped
        if np.array_equal(sunk, label):
            return np.unique(label, return_inverse=True)[1].reshape(-1)
        label = sunk
