"""The robot as a cloud of spheres, for fast clearance of many configurations at once.

Links are covered by spheres along their collision capsules, the hand by spheres along its palm and fingers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.build_model import TABLE_CENTRE, TABLE_HALF
from sim.hand import FINGER_BOXES, FINGER_OFFSET, PALM_BOXES
from sim.kinematics import link_poses
from sim.panda import DISTAL, LINKS, PROXIMAL

Array = NDArray[np.float64]

HAND_LINK = 7
"""Index of the hand in `link_poses`."""
PALM_ROWS = ((-0.003, 0.032), (0.043, 0.026))
"""Height in the hand frame and radius of the two rows of spheres that cover the palm's boxes [m]; the boxes' edges stick
out by at most 7 mm, less than the margin that free motions keep."""
FINGER_RADIUS = 0.012
"""Radius of the fingers' spheres [m]."""


def _link_spheres() -> tuple[Array, NDArray[np.int64], Array]:
    centres, owners, radii = [], [], []
    for number, link in enumerate(LINKS):
        for first, second, radius in link.capsules:
            a, b = np.array(first, float), np.array(second, float)
            count = max(2, int(np.ceil(np.linalg.norm(b - a) / (0.8 * radius))) + 1)
            for share in np.linspace(0.0, 1.0, count):
                centres.append(a + share * (b - a))
                owners.append(number)
                radii.append(radius)
    return np.array(centres), np.array(owners), np.array(radii)


def _hand_spheres(aperture: float = 0.08) -> tuple[Array, Array]:
    """Centres (P, 3) in the hand frame and radii (P,) of spheres that cover palm and fingers at an opening [m]."""
    half_length = PALM_BOXES[0][1][1]
    centres: list[tuple[float, float, float]] = []
    radii: list[float] = []
    for height, radius in PALM_ROWS:
        for y in np.linspace(-1.0, 1.0, 6) * (half_length - 0.75 * radius):
            centres.append((0.0, float(y), height))
            radii.append(radius)
    for sign in (1.0, -1.0):
        for centre, _ in FINGER_BOXES:
            centres.append((0.0, sign * (centre[1] + aperture / 2), centre[2] + FINGER_OFFSET))
            radii.append(FINGER_RADIUS)
    return np.array(centres), np.array(radii)


_CENTRES, _OWNERS, _RADII = _link_spheres()
_HAND_CENTRES, _HAND_RADII = _hand_spheres()
_ALL_CENTRES = np.concatenate([_CENTRES, _HAND_CENTRES])
_ALL_OWNERS = np.concatenate([_OWNERS, np.full(len(_HAND_RADII), HAND_LINK)])
RADII = np.concatenate([_RADII, _HAND_RADII])
"""Radii of all spheres [m], shape (S,)."""
OWN_ROOM = 0.005
"""Distance that wrist and hand keep from the shoulder where something is set down [m]."""
DISTAL_FROM = 4
"""Link index from which the arm could meet its own base (link 5 on)."""
_DISTAL = _ALL_OWNERS >= DISTAL_FROM
_ON_TABLE = _ALL_OWNERS >= 2
_LOW = _OWNERS >= 2
_LOW_CENTRES, _LOW_OWNERS, _LOW_RADII = _CENTRES[_LOW], _OWNERS[_LOW], _RADII[_LOW]
_BACK = _OWNERS <= DISTAL_FROM
_BACK_CENTRES, _BACK_OWNERS, _BACK_RADII = _CENTRES[_BACK], _OWNERS[_BACK], _RADII[_BACK]
_SHOULDER = np.flatnonzero(_ALL_OWNERS < PROXIMAL)
_WRIST = np.flatnonzero(_ALL_OWNERS >= DISTAL - 1)
_TOGETHER = RADII[_SHOULDER][:, None] + RADII[_WRIST][None]
"""Radii of the spheres of shoulder and wrist added up [m]: the pairs of links that can meet."""
_BASE_CAPSULES = (((-0.09, 0.0, 0.06), (0.0, 0.0, 0.06), 0.06), ((0.0, 0.0, 0.05), (0.0, 0.0, 0.333), 0.06))
"""Base and column of the robot itself: end points and radius [m]."""


def spheres(joints: Array) -> Array:
    """Centres of all spheres in the world frame, shape (N, S, 3), for configurations (N, 7)."""
    poses = link_poses(joints)[:, _ALL_OWNERS]
    return np.einsum("nsij,sj->nsi", poses[..., :3, :3], _ALL_CENTRES) + poses[..., :3, 3]


def carried_points(joints: Array, points: Array) -> Array:
    """Points (P, 3) fixed to the hand frame, in the world frame for each configuration (N, 7); shape (N, P, 3)."""
    hand = link_poses(joints)[:, HAND_LINK]
    return np.einsum("nij,pj->npi", hand[:, :3, :3], points) + hand[:, None, :3, 3]


def own_arm_clearance(joints: Array, load: Array, radius: float) -> Array:
    """Smallest distance of what is held from the robot's own links up to the forearm's end [m], shape (N,).

    Args:
        joints: Configurations (N, 7) [rad].
        load: Points of what is held in the world frame for each of them (N, P, 3) [m].
        radius: Radius given to these points [m].
    """
    poses = link_poses(joints)[:, _BACK_OWNERS]
    centres = np.einsum("nsij,sj->nsi", poses[..., :3, :3], _BACK_CENTRES) + poses[..., :3, 3]
    apart = np.linalg.norm(load[:, :, None] - centres[:, None], axis=-1) - _BACK_RADII
    return apart.min(axis=(1, 2)) - radius


def self_clearance(joints: Array) -> float:
    """Smallest distance of wrist and hand from the robot's own shoulder in any of the configurations (N, 7) [m]."""
    return float(_from_shoulder(spheres(joints)).min())


def _from_shoulder(centres: Array) -> Array:
    """Smallest distance of wrist and hand from the shoulder [m], shape (N,), for all spheres (N, S, 3)."""
    apart = centres[:, _SHOULDER, None] - centres[:, None, _WRIST]
    return (np.sqrt(np.einsum("nijk,nijk->nij", apart, apart)) - _TOGETHER).min(axis=(1, 2))


def table_clearance(joints: Array) -> float:
    """Smallest distance of the arm's links (hand left out: its own check is exact) from the table [m]."""
    poses = link_poses(joints)[:, _LOW_OWNERS]
    centres = np.einsum("nsij,sj->nsi", poses[..., :3, :3], _LOW_CENTRES) + poses[..., :3, 3]
    return float(_above_table(centres, _LOW_RADII).min())


def stands_free(path: Array) -> bool:
    """Whether a way down (K, 7) ends with the links off the table, and keeps wrist and hand off the shoulder."""
    return table_clearance(path[[-1]]) > 0.0 and self_clearance(path) > OWN_ROOM


def _above_table(centres: Array, radii: Array) -> Array:
    """Signed distance (N, S) of spheres from the table's box."""
    outside = np.abs(centres - np.asarray(TABLE_CENTRE)) - np.asarray(TABLE_HALF)
    positive = np.maximum(outside, 0.0)
    return np.sqrt((positive**2).sum(-1)) + np.minimum(outside.max(-1), 0.0) - radii


def setting_clearance(centres: Array) -> Array:
    """Smallest distance of each configuration's spheres (N, S, 3) from table, own base and own shoulder [m], shape (N,)."""
    best = _above_table(centres[:, _ON_TABLE], RADII[_ON_TABLE]).min(axis=1)
    moving, radii = centres[:, _DISTAL], RADII[_DISTAL]
    for first, second, radius in _BASE_CAPSULES:
        a, along = np.array(first), np.array(second) - np.array(first)
        share = np.clip((moving - a) @ along / (along @ along), 0.0, 1.0)
        distance = np.linalg.norm(moving - a - share[..., None] * along, axis=-1) - radius - radii
        best = np.minimum(best, distance.min(axis=1))
    return np.minimum(best, _from_shoulder(centres))
