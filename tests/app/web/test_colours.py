"""The page's colours for people who see fewer of them: contrast of text, and pairs that must not be mixed up."""

from __future__ import annotations

import re
from importlib import resources

import numpy as np
import pytest
from numpy.typing import NDArray

from app.web.view import CHOSEN, OTHER, POINTED

SEEN = {
    "full": np.eye(3),
    "protanopia": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
    "deuteranopia": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]),
    "tritanopia": np.array([[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]),
}  # fmt: skip
"""Linear RGB as people see it whose cones of one kind are missing (Machado, Oliveira and Fernandes 2009, table 1)."""
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""sRGB to XYZ with the white of D65 (IEC 61966-2-1)."""
TEXT, SIGN = 4.5, 3.0
"""Contrast that text and signs need (WCAG 2.2, 1.4.3 and 1.4.11)."""
APART = 20.0
"""Difference of two colours in CIE L*a*b* that nobody overlooks; 2.3 is just noticeable."""


def _colours() -> dict[str, str]:
    style = resources.files("app.web").joinpath("static", "page.css").read_text(encoding="utf-8")
    return dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6});", style))


def _linear(colour: str | tuple[int, int, int]) -> NDArray[np.float64]:
    given = bytes.fromhex(colour[1:]) if isinstance(colour, str) else colour
    share = np.array(list(given)) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def _contrast(a: str, b: str) -> float:
    dark, light = sorted(float(TO_XYZ[1] @ _linear(colour)) for colour in (a, b))
    return (light + 0.05) / (dark + 0.05)


def _lab(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    share = TO_XYZ @ np.clip(linear, 0, 1) / (TO_XYZ @ np.ones(3))
    x, y, z = np.where(share > 0.008856, np.cbrt(share), 7.787 * share + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("name", ["blue", "green", "orange", "red", "purple", "ink", "soft"])
def test_text_can_be_read(name: str) -> None:
    """Each colour that text has can be read on every light ground of the page."""
    colours = _colours()
    for ground in ("paper", "tint"):
        assert _contrast(colours[name], colours[ground]) >= TEXT, ground


def test_edges_and_the_focus_can_be_seen() -> None:
    """Edges of fields and the ring around what has the focus stand out, on the dark bar too."""
    colours = _colours()
    assert _contrast(colours["edge"], colours["paper"]) >= SIGN
    assert _contrast(colours["orange"], colours["back"]) >= SIGN
    assert _contrast(colours["amber"], colours["blue-dark"]) >= SIGN


@pytest.mark.parametrize("eyes", SEEN)
def test_states_are_told_apart_by_everyone(eyes: str) -> None:
    """Grippers (chosen, pointed at, others), both force curves, and lamps differ in colour for all eyes."""
    colours = _colours()
    sets = (
        (CHOSEN, POINTED, OTHER),
        (colours["blue"], colours["orange"]),
        (colours["blue"], colours["red"]),
        (colours["green"], colours["red"]),
    )
    for group in sets:
        seen = [_lab(SEEN[eyes] @ _linear(colour)) for colour in group]
        for number, one in enumerate(seen):
            for other in seen[number + 1 :]:
                assert np.linalg.norm(one - other) >= APART, (eyes, group)
