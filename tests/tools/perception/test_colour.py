"""Names of colours."""

from __future__ import annotations

import pytest

from tools.perception.colour import colour_name


@pytest.mark.parametrize(
    ("rgb", "name"),
    [
        ((0.93, 0.82, 0.20), "yellow"),
        ((0.70, 0.55, 0.15), "yellow"),
        ((0.50, 0.40, 0.10), "yellow"),
        ((0.50, 0.32, 0.18), "brown"),
        ((0.62, 0.25, 0.15), "brown"),
        ((0.36, 0.26, 0.19), "brown"),
    ],
)
def test_shaded_yellow_is_no_brown(rgb: tuple[float, float, float], name: str) -> None:
    """An overripe or shaded banana is yellow; wood and clay are brown."""
    assert colour_name(rgb) == name
