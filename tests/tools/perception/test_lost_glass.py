"""Glass of which no pixel is measured is found by the holes that it leaves in both depth pictures."""

from __future__ import annotations

import math

import numpy as np

from tools.open_world import open_world
from tools.perception.calibrate_view import calibrate_view
from tools.perception.look import take_apart
from tools.perception.lost_glass import AGREEMENT, SMALLEST, fit_upright, hole_mask, restore_glass


def test_a_glass_vase_without_a_measured_pixel_is_found_within_a_centimetre() -> None:
    """At twice the noise all depth on glass is lost; the fit of both holes is within 10 mm of the true axis."""
    opened = open_world("cup_near_vase", 13002, noise=2.0)
    front, top = (calibrate_view(view) for view in opened.robot.look(np.random.default_rng(5)))
    hole = hole_mask(front)
    assert hole.sum() > SMALLEST
    fit = fit_upright(hole, front, hole_mask(top), top)
    vase = next(item for item in opened.placed.objects if item.id == "vase")
    assert fit is not None
    assert fit.agreement > AGREEMENT
    assert math.dist((fit.x, fit.y), vase.position[:2]) < 0.010


def test_an_ordinary_picture_is_left_as_it_is() -> None:
    """At ordinary noise half of the pixels on glass remain and the views come back unchanged."""
    opened = open_world("cup_near_vase", 13002, noise=1.0)
    pictures = opened.robot.look(np.random.default_rng(5))
    views = tuple(calibrate_view(view) for view in pictures)
    assert restore_glass(views) is views
    assert len(take_apart(pictures).pieces.cluster) > 0
