"""A grasp straight from stored parameters, without geometric candidates: the literal reading of the paper."""

from __future__ import annotations

import math

import numpy as np

from kb.constraint import Adjustment
from kb.percept import PerceivedObject
from tools.planning.body_candidates import side_floor
from tools.planning.candidate import TABLE_MARGIN, TIP_REACH, Candidate, horizontal, leaning, vec3, wrap
from tools.planning.grasp_prior import GraspPrior


def literal_candidate(subject: PerceivedObject, prior: GraspPrior, adjustment: Adjustment) -> Candidate:
    """Position = centroid of the region, d as stored, psi across the minor axis; only the table bounds the height.

    Args:
        subject: The target.
        prior: Stored parameters, or the fixed defaults.
        adjustment: Direction imposed by constraints and bias away from neighbours (ledger G11).
    """
    part = subject.part(prior.region) if prior.region is not None else None
    centre = np.asarray(part.centre if part is not None else subject.position, float)
    minor = wrap(subject.yaw + math.pi / 2)
    tilt = prior.tilt or 0.0
    radial = math.atan2(centre[1], centre[0])
    direction = np.array(leaning(radial, tilt) if prior.approach != "tilted" else leaning(subject.yaw, tilt))
    if adjustment.direction is not None:
        direction = np.asarray(adjustment.direction, float)
    direction = direction + np.asarray(adjustment.away, float)
    direction /= np.linalg.norm(direction)
    yaw = minor
    if prior.approach == "side":
        yaw = wrap(math.atan2(direction[1], direction[0]) + math.pi / 2)
    elif part is not None and part.region == "rim" and part.radius is not None:
        # The wall nearest to the robot; across the whole mouth nothing could be gripped.
        centre = centre - horizontal(radial) * (part.radius - part.width / 2)
        yaw = wrap(radial)
    height = float(centre[2])
    if prior.depth is not None:
        height = subject.base_z + prior.depth * subject.size[2]
    floor = side_floor(0.0) if prior.approach == "side" else TABLE_MARGIN + TIP_REACH
    return Candidate(
        name="literal parameters",
        region=prior.region or "body",
        type=prior.type or "power",
        position=vec3((centre[0], centre[1], max(height, floor))),
        approach=vec3(direction),
        yaw=yaw,
        width=part.width if part is not None else subject.size[1],
        depth=prior.depth or 0.5,
    )
