"""Where the drawn grippers are, as plain numbers: the page finds out from them which one the pointer is over."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.hand import TCP_OFFSET, hand_boxes

if TYPE_CHECKING:
    from kb.grasp import Grasp


def hand_shape(grasp: Grasp) -> dict[str, list[float] | list[list[float]]]:
    """The hand at this grasp.

    Returns:
        `origin`: the tool centre point (3,) [m], world frame. `axes`: the hand's x, y and z axes in the world, one after
        the other (9,). `boxes`: centre and half size (6,) [m] of each box in that frame.
    """
    boxes = [
        [round(float(value), 4) for value in (centre[0], centre[1], centre[2] - TCP_OFFSET, *half)]
        for centre, half in hand_boxes(grasp.aperture)
    ]
    return {
        "origin": [round(value, 4) for value in grasp.position],
        "axes": [round(float(value), 5) for value in grasp.rotation().T.ravel()],
        "boxes": boxes,
    }
