"""Laws of what the page is told for pointing at grippers and for its lamps."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.web.hands import hand_shape
from app.web.rows import lamps
from kb.grasp import Grasp


def test_the_hand_of_a_grasp_is_where_the_grasp_is() -> None:
    """The pads end a centimetre around the tool point, open by the aperture; the palm lies behind it."""
    grasp = Grasp(position=(0.5, 0.1, 0.2), approach=(0.0, 0.6, -0.8), yaw=0.4, aperture=0.06, force=5.0, type="pinch")
    shape = hand_shape(grasp)
    boxes, axes = np.array(shape["boxes"]), np.array(shape["axes"]).reshape(3, 3)
    assert shape["origin"] == [0.5, 0.1, 0.2]
    assert np.allclose(axes[2], grasp.approach, atol=1e-4)
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-4)
    pads = boxes[np.abs(boxes[:, 2]) < 0.012]
    assert np.allclose(np.sort(np.abs(pads[:, 1]) - pads[:, 4]), 0.03, atol=1e-4)
    assert (boxes[:, 2] + boxes[:, 5]).max() == pytest.approx(0.0088, abs=0.001)
    assert boxes[:, 2].min() < -0.1


def _row(target: str, gap: int) -> dict[str, Any]:
    return {"kind": "collision", "target": target, "reason": f"near the {target}", "gap": gap}


def _measured(target: str, *, inferred: bool = True) -> Any:
    return SimpleNamespace(kind="collision", target=target, inferred=inferred, satisfied=True, measured={})


def test_each_lamp_has_its_own_gap() -> None:
    """Of two neighbours each keeps its own gap and reason; where it is not clear whose it is, none is said."""
    watched = [_row("grey vase (obj_0)", 75), _row("clear glass (obj_2)", 20)]
    result = SimpleNamespace(constraints=[_measured("wine_glass"), _measured("vase"), _measured("plate")])
    shown = lamps(watched, result)
    assert [row["gap"] for row in shown] == [20, 75, None]
    one = lamps(watched[:1], SimpleNamespace(constraints=[_measured("thing"), _measured("vase", inferred=False)]))
    assert [row["gap"] for row in one] == [75, None]
