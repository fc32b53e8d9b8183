"""Forward and inverse kinematics of the Panda, in closed form.

Poses are tool-centre-point poses in the world frame (robot base), shape (4, 4): columns x, y, z of the hand frame and the
position. `frankik` solves the inverse; its conventions are hidden here: its forward kinematics returns the pose of the
tool point, its inverse wants the flange.
"""

from __future__ import annotations

import math

import frankik
import numpy as np
from numpy.typing import NDArray

from kb.grasp import Grasp
from sim.hand import TCP_OFFSET
from sim.panda import FLANGE_OFFSET, HAND_TURN, LINKS, Q_MAX, Q_MIN

Array = NDArray[np.float64]

_FLANGE_TO_TCP = np.eye(4)
_FLANGE_TO_TCP[:2, :2] = [[math.cos(HAND_TURN), -math.sin(HAND_TURN)], [math.sin(HAND_TURN), math.cos(HAND_TURN)]]
_FLANGE_TO_TCP[2, 3] = TCP_OFFSET
# frankik.FrankaKinematics.FrankaHandTCPOffset is rounded to 0.707 and not orthonormal; this is the exact transform.
_TCP_TO_FLANGE = np.linalg.inv(_FLANGE_TO_TCP)

_A = np.array([link.a for link in LINKS])
_D = np.array([link.d for link in LINKS])
_COS_ALPHA = np.cos([link.alpha for link in LINKS])
_SIN_ALPHA = np.sin([link.alpha for link in LINKS])
_TURNS = list(zip(_A.tolist(), _D.tolist(), _COS_ALPHA.tolist(), _SIN_ALPHA.tolist(), strict=True))
LIMIT_MARGIN = 0.03
"""Distance kept from every joint limit [rad]."""
CLOSED_FORM_ERROR = 1e-4
"""A closed-form solution farther than this from the wanted pose [m] is refused (worst near singularities: 7e-4 m)."""


def forward(joints: Array) -> Array:
    """Tool pose (4, 4) of one configuration (7,)."""
    return np.asarray(frankik.fk(np.asarray(joints, float)))


def link_poses(joints: Array) -> Array:
    """Poses of links 1 to 7 and of the hand (flange, turned) of many configurations.

    Args:
        joints: Joint angles [rad], shape (N, 7).

    Returns:
        Transforms link-to-world, shape (N, 8, 4, 4); the last one is the hand frame.
    """
    joints = np.asarray(joints, float).reshape(-1, 7)
    count = len(joints)
    cos, sin = np.cos(joints), np.sin(joints)
    step = np.zeros((count, 7, 4, 4))
    # Craig's modified DH transform of row i: Rot_x(alpha) Trans_x(a) Rot_z(theta) Trans_z(d).
    step[:, :, 0, 0], step[:, :, 0, 1], step[:, :, 0, 3] = cos, -sin, _A
    step[:, :, 1, 0], step[:, :, 1, 1] = sin * _COS_ALPHA, cos * _COS_ALPHA
    step[:, :, 1, 2], step[:, :, 1, 3] = -_SIN_ALPHA, -_SIN_ALPHA * _D
    step[:, :, 2, 0], step[:, :, 2, 1] = sin * _SIN_ALPHA, cos * _SIN_ALPHA
    step[:, :, 2, 2], step[:, :, 2, 3] = _COS_ALPHA, _COS_ALPHA * _D
    step[:, :, 3, 3] = 1.0
    poses = np.empty((count, 8, 4, 4))
    poses[:, 0] = step[:, 0]
    for row in range(1, 7):
        poses[:, row] = poses[:, row - 1] @ step[:, row]
    poses[:, 7] = poses[:, 6] @ _LINK7_TO_HAND
    return poses


_LINK7_TO_HAND = _FLANGE_TO_TCP.copy()
_LINK7_TO_HAND[2, 3] = FLANGE_OFFSET


def tcp_poses(joints: Array) -> Array:
    """Tool poses (N, 4, 4) of many configurations (N, 7)."""
    poses = link_poses(joints)[:, 7].copy()
    poses[:, :3, 3] += TCP_OFFSET * poses[:, :3, 2]
    return poses


def _tool_points(joints: Array) -> Array:
    """Tool points (N, 3) [m] of many configurations (N, 7): `tcp_poses` without the poses, from the hand to the base."""
    count = len(joints)
    x, y, z = np.zeros(count), np.zeros(count), np.full(count, FLANGE_OFFSET + TCP_OFFSET)
    for cos, sin, link in zip(np.cos(joints).T[::-1], np.sin(joints).T[::-1], _TURNS[::-1], strict=True):
        a, d, cos_alpha, sin_alpha = link
        z += d
        x, turned = cos * x - sin * y + a, sin * x + cos * y
        y, z = turned * cos_alpha - z * sin_alpha, turned * sin_alpha + z * cos_alpha
    return np.stack([x, y, z], axis=1)


def jacobian(joints: Array) -> Array:
    """Geometric Jacobian of the tool point, shape (6, 7): linear rows [m/rad], then angular rows."""
    poses = link_poses(np.asarray(joints, float)[None])[0]
    tcp = poses[7, :3, 3] + TCP_OFFSET * poses[7, :3, 2]
    axes = poses[:7, :3, 2]
    arm = tcp - poses[:7, :3, 3]
    out = np.empty((6, 7))
    # The cross product axes x arm, written out: numpy's own costs more than everything else here.
    out[0] = axes[:, 1] * arm[:, 2] - axes[:, 2] * arm[:, 1]
    out[1] = axes[:, 2] * arm[:, 0] - axes[:, 0] * arm[:, 2]
    out[2] = axes[:, 0] * arm[:, 1] - axes[:, 1] * arm[:, 0]
    out[3:] = axes.T
    return out


def grasp_pose(grasp: Grasp) -> Array:
    """The tool pose (4, 4) at which the fingers close."""
    pose = np.eye(4)
    pose[:3, :3] = grasp.rotation()
    pose[:3, 3] = grasp.position
    return pose


def flipped(pose: Array) -> Array:
    """The same grasp with the hand turned by half a turn about its approach: the fingers change places."""
    out = pose.copy()
    out[:3, :2] *= -1.0
    return out


def within_limits(joints: Array, margin: float = LIMIT_MARGIN) -> NDArray[np.bool_]:
    """Which configurations (..., 7) are finite and keep `margin` [rad] from every limit, shape (...)."""
    with np.errstate(invalid="ignore"):
        inside = (joints > Q_MIN + margin) & (joints < Q_MAX - margin)
    return np.asarray(inside.all(axis=-1))


def inverse(pose: Array, q7: float, near: Array) -> Array:
    """All closed-form solutions (K, 7), K <= 4, of a tool pose for a given last joint angle [rad]; limits unchecked."""
    solutions = closed_forms(flanges(pose), q7, near)
    return solutions[np.isfinite(solutions).all(axis=1)]


def flanges(poses: Array) -> Array:
    """Poses of the flange (..., 4, 4) at tool poses."""
    return poses @ _TCP_TO_FLANGE


def closed_forms(flange: Array, q7: float, near: Array) -> Array:
    """As `inverse` for a pose of the flange, with the rows that are no solutions: they are not numbers (4, 7)."""
    return np.asarray(frankik.ik_full(flange, near, q7))


def inverse_many(pose: Array, q7s: Array, near: Array, margin: float = LIMIT_MARGIN) -> Array:
    """Closed-form solutions (K, 7) within the limits over many last joint angles, each checked by forward kinematics."""
    flange = flanges(pose)
    found = np.concatenate([frankik.ik_full(flange, near, float(q7)) for q7 in q7s])
    found = found[within_limits(found, margin)]
    if not len(found):
        return found
    off = _tool_points(found)
    off -= pose[:3, 3]
    return found[np.sqrt((off * off).sum(axis=1)) < CLOSED_FORM_ERROR]


def pose_error(wanted: Array, actual: Array) -> Array:
    """Error twist (6,): position [m] and rotation vector [rad] that move `actual` onto `wanted`."""
    turn = wanted[:3, :3] @ actual[:3, :3].T
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine, cosine = math.sqrt(axis.dot(axis)) / 2.0, (float(np.trace(turn)) - 1.0) / 2.0
    angle = math.atan2(sine, cosine)
    scale = 0.5 if sine < 1e-9 else angle / (2.0 * sine)
    return np.concatenate([wanted[:3, 3] - actual[:3, 3], scale * axis])


def refine(pose: Array, start: Array, *, steps: int = 30, damping: float = 0.02) -> tuple[Array, float]:
    """The configuration within limits nearest to a tool pose, by damped least squares from `start`.

    Serves to follow a path closely from sample to sample, and to measure how far an unreachable pose is out of reach.

    Returns:
        Joints (7,) and the remaining error: distance of the tool point [m] plus 0.1 m per radian of rotation.
    """
    joints = np.clip(start, Q_MIN + LIMIT_MARGIN, Q_MAX - LIMIT_MARGIN)
    error = pose_error(pose, forward(joints))
    best, best_norm = joints, _norm(error)
    for _ in range(steps):
        if best_norm < 1e-6:
            break
        jac = jacobian(joints)
        push = jac.T @ np.linalg.solve(jac @ jac.T + damping**2 * np.eye(6), error)
        joints = np.clip(joints + np.clip(push, -0.3, 0.3), Q_MIN + LIMIT_MARGIN, Q_MAX - LIMIT_MARGIN)
        error = pose_error(pose, forward(joints))
        norm = _norm(error)
        if norm < best_norm:
            best, best_norm = joints, norm
        damping = max(1e-4, damping * 0.6)
    return best, best_norm


def _norm(error: Array) -> float:
    return math.sqrt(error[:3].dot(error[:3])) + 0.1 * math.sqrt(error[3:].dot(error[3:]))
