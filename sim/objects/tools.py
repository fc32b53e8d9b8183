"""Screwdriver, pen and key: long things that lie along x (ledger G37)."""

from __future__ import annotations

from collections.abc import Callable

from kb.percept import Part
from kb.vocabulary import Region
from sim.objects.form import Colour, Form, box, denser, lying_cylinder
from sim.placed import Geom

X = (1.0, 0.0, 0.0)
STEEL = (0.66, 0.67, 0.70, 1.0)


def screwdriver(scale: float, colour: Callable[[], Colour]) -> Form:
    """The screwdriver of Table I: 3 x 3 x 20 cm, half of it handle; eight-sided, so that it does not roll."""
    s = scale
    handle = _bar(-0.10 * s, 0.0, 0.030 * s, colour(), "handle")
    shaft = denser(lying_cylinder(0.0, 0.10 * s, 0.0035 * s, 0.015 * s, STEEL, "body"), 6.0)  # steel, not plastic
    parts = (
        Part(region="handle", centre=(-0.05 * s, 0.0, 0.015 * s), axis=X, width=0.03 * s, length=0.10 * s),
        Part(region="body", centre=(0.05 * s, 0.0, 0.015 * s), axis=X, width=0.007 * s, length=0.10 * s),
    )
    return Form((*handle, shaft), parts, (0.20 * s, 0.03 * s, 0.03 * s))


def pen(scale: float, colour: Callable[[], Colour]) -> Form:
    """A thick pen: 14 cm long, 1.2 cm across, eight-sided."""
    s = scale
    barrel, cap = colour(), colour()
    geoms = (*_bar(-0.07 * s, 0.03 * s, 0.012 * s, barrel, "body"), *_bar(0.03 * s, 0.07 * s, 0.012 * s, cap, "body"))
    part = Part(region="body", centre=(0.0, 0.0, 0.006 * s), axis=X, width=0.012 * s, length=0.14 * s)
    return Form(geoms, (part,), (0.14 * s, 0.012 * s, 0.012 * s))


def key(scale: float, colour: Callable[[], Colour]) -> Form:
    """An old warded key: a bow, a square shank of 8 mm and a bit; 8 cm long."""
    s, rgba = scale, colour()
    half = 0.004 * s
    geoms = (
        box((-0.029 * s, 0.0, half), (0.011 * s, 0.013 * s, half), rgba),
        box((0.011 * s, 0.0, half), (0.029 * s, half, half), rgba),
        box((0.033 * s, 0.010 * s, half), (0.005 * s, 0.006 * s, half), rgba),
    )
    part = Part(region="body", centre=(0.0, 0.0, half), axis=X, width=2 * half, length=0.08 * s)
    return Form(geoms, (part,), (0.08 * s, 0.029 * s, 2 * half))


def _bar(start: float, end: float, across: float, rgba: Colour, region: Region) -> list[Geom]:
    """A bar along x with an eight-cornered cross-section `across` wide and high [m], resting on a flat face."""
    centre = ((start + end) / 2, 0.0, across / 2)
    long, full, flat = (end - start) / 2, across / 2, 0.68 * across / 2
    return [
        box(centre, (long, full, flat), rgba, region),
        box(centre, (long, flat, full), rgba, region),
    ]
