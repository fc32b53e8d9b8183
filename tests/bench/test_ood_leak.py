"""Nothing outside the distribution has been seen before: not as reference view, not as experience, not by name."""

from __future__ import annotations

import inspect

import pytest

from bench import make_references, reference_views
from bench.suite import tasks_of
from kb.errors import BadInputError
from kb.references import load_references
from kb.store import ExperienceStore
from kb.taxonomy import taxonomy
from sim.ood_catalogue import FAR, NEAR
from sim.tasks import random_scene
from tools.experience.recipe import category_plans

NEW = {*NEAR, *FAR}
FAR_CATEGORIES = {entry.category for entry in FAR.values()}


def test_reference_views_are_of_the_catalogue_alone() -> None:
    """The models that references are rendered from, and the categories they end up with, hold no new object."""
    assert not NEW & set(reference_views.MODELS_SEEN)
    assert not FAR_CATEGORIES & set(load_references().categories)
    for module in (reference_views, make_references, random_scene):
        assert "ood_catalogue" not in inspect.getsource(module)


def test_experiences_are_of_the_catalogue_alone() -> None:
    """No recipe names a new object, and no stored experience has the category of a far one."""
    assert not NEW & {model for plan in category_plans() for model in plan.models}
    stored = ExperienceStore.open(None).all()
    assert not FAR_CATEGORIES & {entry.category for entry in stored}


def test_the_blind_taxonomy_knows_no_far_category() -> None:
    """Under `blind` no far object has a superclass, so that only the fallback of level 1 can find anything."""
    blind, known = taxonomy("blind"), taxonomy("known")
    assert all(blind.superclass(category) is None for category in FAR_CATEGORIES)
    assert any(known.superclass(category) is not None for category in FAR_CATEGORIES)


def test_suite_and_groups() -> None:
    """42 tasks in three suites; groups by name; an unknown one is refused with the choices."""
    tasks = tasks_of("ood")
    counts = {suite: sum(task.suite == suite for task in tasks) for suite in ("ood_in_dist", "ood_near", "ood_far")}
    assert counts == {"ood_in_dist": 12, "ood_near": 15, "ood_far": 15}
    assert tasks_of("ood", ["far"])[0].name == "ood_thermos"
    with pytest.raises(BadInputError, match="ood_samovar"):
        tasks_of("ood", ["ood_samovar"])
    assert all([task.name.startswith("ood_") for task in tasks])
