"""Vessels of categories that neither the knowledge base nor the benchmark has (far out of distribution)."""

from __future__ import annotations

from collections.abc import Callable

from sim.objects.form import Colour, Form, capsule, cylinder, frustum, sphere, wall
from sim.objects.ood.parts import loop_handle, rim, round_body
from sim.placed import Cavity

Colours = Callable[[], Colour]
LID = (0.12, 0.12, 0.13, 1.0)


def thermos(scale: float, colour: Colours) -> Form:
    """A thermos: 7 x 7 x 25 cm, a cup of another colour on top."""
    s, rgba, cup = scale, colour(), colour()
    geoms = (
        cylinder(0.035 * s, 0.0, 0.188 * s, rgba),
        frustum((0.035 * s, 0.188 * s), (0.029 * s, 0.198 * s), rgba),
        cylinder(0.029 * s, 0.197 * s, 0.250 * s, (*cup[:3], 1.0), "neck"),
    )
    return Form(geoms, (round_body(0.035 * s, 0.0, 0.188 * s),), (0.07 * s, 0.07 * s, 0.25 * s))


def soup_can(scale: float, colour: Colours) -> Form:
    """A full can: 6.6 cm across, 10.1 cm high, a paper label between two metal rings."""
    s, label, metal = scale, colour(), (0.70, 0.71, 0.73, 1.0)
    geoms = (
        cylinder(0.033 * s, 0.0, 0.006 * s, metal),
        cylinder(0.033 * s, 0.006 * s, 0.095 * s, label),
        cylinder(0.033 * s, 0.095 * s, 0.101 * s, metal),
    )
    return Form(geoms, (round_body(0.033 * s, 0.0, 0.101 * s),), (0.066 * s, 0.066 * s, 0.101 * s))


def spice_jar(scale: float, colour: Colours) -> Form:
    """A jar of glass: 5 x 5 x 10 cm with its dark lid."""
    s, rgba = scale, colour()
    geoms = (
        cylinder(0.025 * s, 0.0, 0.072 * s, rgba),
        frustum((0.025 * s, 0.072 * s), (0.021 * s, 0.080 * s), rgba),
        cylinder(0.0225 * s, 0.079 * s, 0.100 * s, LID, "neck"),
    )
    return Form(geoms, (round_body(0.025 * s, 0.0, 0.072 * s),), (0.05 * s, 0.05 * s, 0.10 * s))


def teapot(scale: float, colour: Colours) -> Form:
    """A small teapot: 16 x 12 x 13 cm with handle and spout, a lid with a knob."""
    s, rgba = scale, colour()
    geoms = [
        frustum((0.040 * s, 0.0), (0.060 * s, 0.030 * s), rgba),
        cylinder(0.060 * s, 0.029 * s, 0.060 * s, rgba),
        frustum((0.060 * s, 0.060 * s), (0.042 * s, 0.098 * s), rgba),
        frustum((0.040 * s, 0.098 * s), (0.014 * s, 0.112 * s), rgba),
        sphere((0.0, 0.0, 0.121 * s), 0.009 * s, rgba),
        capsule((-0.050 * s, 0.0, 0.055 * s), (-0.067 * s, 0.0, 0.092 * s), 0.008 * s, rgba),
    ]
    loop, handle = loop_handle(0.048 * s, 0.085 * s, 0.062 * s, 0.072 * s, 0.015 * s, 0.010 * s, rgba)
    parts = (handle, round_body(0.060 * s, 0.0, 0.098 * s))
    return Form((*geoms, *loop), parts, (0.16 * s, 0.12 * s, 0.13 * s))


def watering_can(scale: float, colour: Colours) -> Form:
    """A watering can for flower pots: 18 x 9 x 14 cm, a long spout in front, a loop behind."""
    s, rgba, sheet = scale, colour(), 0.003
    middle = 0.045 * s - sheet / 2
    geoms = [cylinder(0.044 * s, 0.0, 0.005, rgba), *wall((middle, 0.003), (middle, 0.125 * s), sheet, 16, rgba)]
    geoms += [capsule((-0.045 * s, 0.0, 0.035 * s), (-0.087 * s, 0.0, 0.132 * s), 0.008 * s, rgba)]
    loop, handle = loop_handle(0.043 * s, 0.085 * s, 0.070 * s, 0.085 * s, 0.020 * s, 0.011 * s, rgba)
    parts = (handle, rim(middle, 0.125 * s, sheet, 0.12 * s), round_body(0.045 * s, 0.0, 0.125 * s))
    cavity = Cavity(floor=0.006, top=0.125 * s, radius_floor=0.041 * s, radius_top=0.041 * s)
    return Form((*geoms, *loop), parts, (0.18 * s, 0.09 * s, 0.14 * s), cavity)


def dinner_plate(scale: float, colour: Colours) -> Form:
    """A plate: 20 cm across, 2.2 cm high, a rim of 5 mm; it lies on a stand of 3 cm."""
    s, rgba, sheet = scale, colour(), 0.005
    geoms = [cylinder(0.072 * s, 0.0, 0.005 * s, rgba)]
    geoms += wall((0.072 * s, 0.0025 * s), (0.0983 * s, 0.0203 * s), sheet, 24, rgba, "rim")
    parts = (rim(0.0983 * s, 0.022 * s, sheet, 0.018 * s),)
    return Form(tuple(geoms), parts, (0.20 * s, 0.20 * s, 0.022 * s))


def plate_stand(scale: float, colour: Colours) -> Form:
    """What the plate lies on: a wooden disc, 9 cm across and 3 cm high."""
    s = scale
    return Form(
        (cylinder(0.045 * s, 0.0, 0.03 * s, colour()),),
        (round_body(0.045 * s, 0.0, 0.03 * s),),
        (0.09 * s, 0.09 * s, 0.03 * s),
    )
