"""Grasps of slim parts: a cup's loop handle, a stem, a neck, and the handle of a tool that lies on the table."""

from __future__ import annotations

import math

import numpy as np

from kb.percept import Part, PerceivedObject
from kb.vocabulary import GraspType
from tools.planning.body_candidates import palm_floor, side_floor, side_grips, tip_floor
from tools.planning.candidate import (
    Candidate,
    degrees,
    depth_of,
    horizontal,
    leaning,
    vec3,
    wrap,
)

LOOP_DIPS = tuple(math.radians(a) for a in (0, 20, 45, 65))
"""How far the approach from outside onto a loop handle points down [rad]."""
TOOL_TILTS = tuple(math.radians(a) for a in (40, -40, 35, -35, 45, -45, 50, -50))
"""Tilts off vertical along the shaft of a lying tool [rad] (ledger G38: 30 to 60 degrees)."""
STEM_DIP = math.radians(20.0)
"""Dip at which a stem is taken: the hand stays over the foot and under the bowl (physics.md)."""


def loop_candidates(subject: PerceivedObject, handle: Part) -> list[Candidate]:
    """Grasps of a loop handle: from above closing tangentially, and from outside."""
    if handle.outward is None:
        return []
    out_azimuth = math.atan2(handle.outward[1], handle.outward[0])
    tangent = wrap(out_azimuth + math.pi / 2)
    bar_top = handle.centre[2] + handle.length / 2
    found: list[Candidate] = []
    # From above: as deep as the palm above the vessel's edge allows, on the upper half of the bar.
    for turn in (0.0, math.radians(20), math.radians(-20)):
        height = max(handle.centre[2], palm_floor(subject.top_z, 0.0))
        if height > bar_top + 0.002:
            break
        found.append(
            _loop_grip(subject, handle, "pinch", f"top/turn{degrees(turn)}", (0.0, 0.0, -1.0), tangent + turn, height)
        )
    for dip in LOOP_DIPS:
        height = max(handle.centre[2], side_floor(dip))
        if height > bar_top - 0.004:
            continue
        for turn in (0.0, math.radians(25), math.radians(-25)):
            inward = horizontal(out_azimuth + math.pi + turn) * math.cos(dip)
            approach = vec3(inward - np.array([0.0, 0.0, math.sin(dip)]))
            label = f"side/dip{degrees(dip)}/turn{degrees(turn)}"
            type_: GraspType = "side" if dip < math.radians(60) else "pinch"
            found.append(_loop_grip(subject, handle, type_, label, approach, tangent + turn, height))
    return found


def _loop_grip(
    subject: PerceivedObject,
    handle: Part,
    type_: GraspType,
    label: str,
    approach: tuple[float, float, float],
    yaw: float,
    height: float,
) -> Candidate:
    return Candidate(
        name=f"handle/loop/{label}",
        region="handle",
        type=type_,
        position=(handle.centre[0], handle.centre[1], height),
        approach=approach,
        yaw=wrap(yaw),
        width=handle.width,
        miss=max(0.0, abs(height - handle.centre[2]) - handle.length / 3),
        depth=depth_of(subject, height),
        merit=-min(0.3, 6.0 * abs(height - handle.centre[2])) - (0.1 if "turn0" not in label else 0.0),
    )


def stem_candidates(subject: PerceivedObject, stem: Part) -> list[Candidate]:
    """Side grasps of a vertical stem, dipping so that the hand stays above the foot and below the bowl."""
    found: list[Candidate] = []
    for share in (0.15, 0.25, -0.15, 0.0):
        height = stem.centre[2] + share * stem.length
        found += side_grips(
            subject,
            "stem",
            f"h{round(100 * share):+d}",
            np.asarray(stem.centre),
            height,
            stem.width,
            None,
            dips=(STEM_DIP, math.radians(10), math.radians(30)),
            best_dip=STEM_DIP,
        )
    return found


def neck_candidates(subject: PerceivedObject, neck: Part) -> list[Candidate]:
    """Grasps of a vertical neck: from the side, and from above where it ends the object."""
    found = side_grips(subject, "neck", "mid", np.asarray(neck.centre), neck.centre[2], neck.width, None)
    for label, share in (("low", -0.25), ("high", 0.25)):
        height = neck.centre[2] + share * neck.length
        found += side_grips(subject, "neck", label, np.asarray(neck.centre), height, neck.width, None)
    height = max(neck.centre[2], palm_floor(subject.top_z, 0.0))
    if height <= neck.centre[2] + neck.length / 2:
        for k in range(6):
            yaw = wrap(math.pi * k / 6)
            found.append(
                Candidate(
                    name=f"neck/top/yaw{k * 30}",
                    region="neck",
                    type="pinch",
                    position=(neck.centre[0], neck.centre[1], height),
                    approach=(0.0, 0.0, -1.0),
                    yaw=yaw,
                    width=neck.width,
                    depth=depth_of(subject, height),
                    merit=-0.1,
                )
            )
    return found


def tool_candidates(subject: PerceivedObject, handle: Part) -> list[Candidate]:
    """Grasps of the handle of a lying tool: fingers across the shaft, the hand tilted along it or upright."""
    shaft = math.atan2(handle.axis[1], handle.axis[0])
    closing = wrap(shaft + math.pi / 2)
    found: list[Candidate] = []
    for share in (0.0, 0.2, -0.2):
        point = np.asarray(handle.centre) + np.asarray(handle.axis) * share * handle.length
        for tilt in (*TOOL_TILTS, 0.0):
            height = max(handle.centre[2], tip_floor(subject, tilt), palm_floor(subject.top_z, tilt))
            kinds: tuple[GraspType, ...] = ("side",) if tilt else ("power", "pinch")
            for type_ in kinds:
                found.append(
                    Candidate(
                        name=f"handle/tool/{type_}/at{round(100 * share):+d}/tilt{degrees(tilt)}",
                        region="handle",
                        type=type_,
                        position=vec3((point[0], point[1], height)),
                        approach=leaning(shaft, tilt),
                        yaw=closing,
                        width=handle.width,
                        miss=abs(share) * handle.length * 0.3 + max(0.0, height - handle.centre[2] - 0.008),
                        depth=depth_of(subject, height),
                        merit=-abs(abs(tilt) - math.radians(40)) * (0.5 if tilt else 0.0) - 0.4 * abs(share),
                    )
                )
    return found
