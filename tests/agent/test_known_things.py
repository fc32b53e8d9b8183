"""What a thing is called when experiences are looked up."""

from __future__ import annotations

import pytest

from agent.goal import Reference
from agent.known_things import called
from kb.taxonomy import taxonomy
from tests.planning_fixtures import solid


@pytest.mark.parametrize(
    ("category", "reference", "known", "blind"),
    [
        ("unknown", Reference(noun="hammer"), "hammer", "unknown"),
        ("unknown", Reference(noun="mug", categories=("mug",)), "mug", "mug"),
        ("unknown", Reference(noun="ball", categories=("tennis_ball",)), "tennis_ball", "tennis_ball"),
        ("unknown", Reference(noun="teapot"), "unknown", "unknown"),
        ("unknown", None, "unknown", "unknown"),
        ("apple", Reference(noun="hammer"), "apple", "apple"),
    ],
)
def test_an_unknown_thing_goes_by_its_name(category: str, reference: Reference | None, known: str, blind: str) -> None:
    """What no category fits is looked up by the person's noun where the taxonomy has it; what was recognised never is."""
    thing = solid("t", "cube", 0.5, 0.1).model_copy(update={"category": category})
    assert called(thing, reference, taxonomy("known")) == known
    assert called(thing, reference, taxonomy("blind")) == blind
