"""The Franka Emika Panda with its hand, as MJCF text.

Sources: kinematics are Franka's published modified (Craig) Denavit-Hartenberg parameters; limits of position, velocity
and torque are Franka's published joint limits (FCI documentation, "Robot and interface specifications"); inertial
parameters are those identified by C. Gaz, M. Cognetti, A. Oliva, P. Robuffo Giordano, A. De Luca, "Dynamic
Identification of the Franka Emika Panda Robot With Retrieval of Feasible Parameters Using Penalty-Based Optimization",
IEEE RA-L 4(4), 2019. Collision shapes are primitives fitted to the visual meshes; box pads grip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.hand import FINGER_BOXES, FINGER_OFFSET, PAD, PALM_BOXES, TCP_OFFSET

QUARTER = math.pi / 2


@dataclass(frozen=True)
class LinkCfg:
    """One moving link: its joint's DH row, limits, inertia and collision capsules."""

    a: float
    """Craig DH a of the joint [m]."""
    d: float
    """Craig DH d of the joint [m]."""
    alpha: float
    """Craig DH alpha of the joint [rad]."""
    range: tuple[float, float]
    """Joint limits [rad]."""
    velocity: float
    """Velocity limit [rad/s]."""
    acceleration: float
    """Acceleration limit [rad/s^2]."""
    torque: float
    """Torque limit [N m]."""
    mass: float
    """[kg]"""
    com: tuple[float, float, float]
    """Centre of mass in the link's frame [m]."""
    inertia: tuple[float, float, float, float, float, float]
    """xx, yy, zz, xy, xz, yz about the centre of mass [kg m^2]."""
    capsules: tuple[tuple[tuple[float, float, float], tuple[float, float, float], float], ...]
    """Collision capsules: end points and radius in the link's frame [m]."""


LINKS: tuple[LinkCfg, ...] = (
    LinkCfg(
        0.0, 0.333, 0.0, (-2.8973, 2.8973), 2.1750, 15.0, 87.0, 4.970684, (3.875e-3, 2.081e-3, -4.762e-2),
        (7.0337e-1, 7.0661e-1, 9.1170e-3, -1.3900e-4, 6.7720e-3, 1.9169e-2),
        (((0, 0, -0.19), (0, 0, -0.06), 0.06), ((0, -0.06, 0), (0, 0, 0), 0.06)),
    ),
    LinkCfg(
        0.0, 0.0, -QUARTER, (-1.7628, 1.7628), 2.1750, 7.5, 87.0, 0.646926, (-3.141e-3, -2.872e-2, 3.495e-3),
        (7.9620e-3, 2.8110e-2, 2.5995e-2, -3.9250e-3, 1.0254e-2, 7.0400e-4),
        (((0, -0.13, 0), (0, -0.06, 0), 0.06), ((0, 0, 0.06), (0, 0, 0), 0.06)),
    ),
    LinkCfg(
        0.0, 0.316, QUARTER, (-2.8973, 2.8973), 2.1750, 10.0, 87.0, 3.228604, (2.7518e-2, 3.9252e-2, -6.6502e-2),
        (3.7242e-2, 3.6155e-2, 1.0830e-2, -4.7610e-3, -1.1396e-2, -1.2805e-2),
        (((0, 0, -0.06), (0, 0, -0.03), 0.06), ((0.0825, 0.05, 0), (0.0825, -0.02, 0), 0.055)),
    ),
    LinkCfg(
        0.0825, 0.0, QUARTER, (-3.0718, -0.0698), 2.1750, 12.5, 87.0, 3.587895, (-5.317e-2, 1.04419e-1, 2.7454e-2),
        (2.5853e-2, 1.9552e-2, 2.8323e-2, 7.7960e-3, -1.3320e-3, 8.6410e-3),
        (((0, 0, 0), (0, 0, 0.05), 0.055), ((-0.0825, 0.06, 0), (-0.0825, 0.07, 0), 0.055)),
    ),
    LinkCfg(
        -0.0825, 0.384, -QUARTER, (-2.8973, 2.8973), 2.6100, 15.0, 12.0, 1.225946, (-1.1953e-2, 4.1065e-2, -3.8437e-2),
        (3.5549e-2, 2.9474e-2, 8.6270e-3, -2.1170e-3, -4.0370e-3, 2.2900e-4),
        (
            ((0, 0, -0.23), (0, 0, -0.20), 0.055),
            ((0, 0.02, -0.20), (0, 0.09, -0.05), 0.035),
            ((0, 0.05, 0), (0, 0, 0), 0.05),
        ),
    ),
    LinkCfg(
        0.0, 0.0, QUARTER, (-0.0175, 3.7525), 2.6100, 20.0, 12.0, 1.666555, (6.0149e-2, -1.4117e-2, -1.0517e-2),
        (1.9640e-3, 4.3540e-3, 5.4330e-3, 1.0900e-4, -1.1580e-3, 3.4100e-4),
        (((0, 0, 0), (0.07, 0.01, 0), 0.05), ((0.088, 0.03, 0), (0.088, 0, 0), 0.048)),
    ),
    LinkCfg(
        0.088, 0.0, QUARTER, (-2.8973, 2.8973), 2.6100, 20.0, 12.0, 0.735522, (1.0517e-2, -4.252e-3, 6.1597e-2),
        (1.2516e-2, 1.0027e-2, 4.8150e-3, -4.2800e-4, -1.1960e-3, -7.4100e-4),
        (((0, 0, 0.06), (0, 0, 0.075), 0.045), ((0.03, 0.03, 0.085), (0.06, 0.06, 0.085), 0.02)),
    ),
)  # fmt: skip
"""The seven moving links in order; DH rows are (a, d, alpha) of the joint that moves the link."""

BASE_CAPSULE = ((-0.09, 0.0, 0.06), (0.0, 0.0, 0.06), 0.06)
"""Collision capsule of the fixed base [m]."""
FLANGE_OFFSET = 0.107
"""Link 7 to flange along z [m] (Craig DH, row 8)."""
HAND_TURN = -math.pi / 4
"""The hand is mounted turned by this angle about z [rad] (Franka hand description)."""
Q_MIN = np.array([link.range[0] for link in LINKS])
Q_MAX = np.array([link.range[1] for link in LINKS])
Q_VELOCITY = np.array([link.velocity for link in LINKS])
Q_ACCELERATION = np.array([link.acceleration for link in LINKS])
READY = np.array([0.0, -math.pi / 4, 0.0, -3 * math.pi / 4, 0.0, math.pi / 2, math.pi / 4])
"""Franka's "ready" pose [rad]: the home of every motion; it hides nothing of the table from the cameras."""

HAND_MASS = 0.73
"""Mass of the hand without fingers [kg] (Franka hand datasheet)."""
HAND_COM = (-0.01, 0.0, 0.03)
"""Its centre of mass in the hand frame [m] (Franka hand datasheet)."""
FINGER_MASS = 0.015
"""[kg]"""
FINGER_COM = (0.0, 0.015, 0.025)
"""In the finger's frame [m]."""

KP = (4500.0, 4500.0, 3500.0, 3500.0, 2000.0, 2000.0, 2000.0)
"""Position gains of the joints [N m/rad]: tracks to 0.2 mm with the feed-forward inputs."""
KV = (450.0, 450.0, 350.0, 350.0, 200.0, 200.0, 200.0)
"""Velocity gains [N m s/rad]: a tenth of KP, over-damped for the arm's inertias."""
GRIP_KP, GRIP_KV = 3000.0, 60.0
"""Gains of the gripper on the sum of both finger positions [N/m], [N s/m]; the force range caps the force."""
GRIP_SLEW = 0.10
"""Speed of the opening [m/s]: 50 mm/s per finger (Franka hand datasheet)."""
FINGER_TRAVEL = 0.04
"""Travel of one finger [m]."""
PAD_FRICTION = 0.3
"""Sliding friction of the pads against things of no friction of their own (objects have priority and bring theirs)."""

# Collision bits: 1 objects, 2 robot, 4 table and floor, 8 hand and forearm against the robot's own base.
ROBOT_BIT, SELF_BIT = 2, 8
PROXIMAL, DISTAL = 2, 5
"""Links up to PROXIMAL collide with links from DISTAL on (the rest cannot meet within the joint limits)."""

MESH_FOLDER = ("rtbdata", "meshes", "FRANKA-EMIKA", "Panda")


def _numbers(values: object) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)  # type: ignore[attr-defined]


def _capsule(ends: tuple[tuple[float, ...], tuple[float, ...], float], bits: str) -> str:
    first, second, radius = ends
    return f'<geom class="col" {bits} type="capsule" fromto="{_numbers((*first, *second))}" size="{radius}"/>'


def _visual(mesh: str, visual: bool) -> str:
    return f'<geom class="vis" mesh="{mesh}"/>' if visual else ""


def _finger(side: str, turn: str, visual: bool) -> str:
    """A finger's body with its slide joint, collision boxes and pad."""
    bits = f'contype="{ROBOT_BIT | SELF_BIT}" conaffinity="0"'
    geoms = ""
    for index, (centre, half) in enumerate(FINGER_BOXES):
        name = f"robot/{side}_{'pad' if index == PAD else f'finger_{index}'}"
        kind = "pad" if index == PAD else "col"
        geoms += (
            f'<geom class="{kind}" {bits} name="{name}" type="box" pos="{_numbers(centre)}" size="{_numbers(half)}"/>'
        )
    return (
        f'<body name="robot/{side}_finger" pos="0 0 {FINGER_OFFSET}" quat="{turn}" gravcomp="1">'
        f'<inertial mass="{FINGER_MASS}" pos="{_numbers(FINGER_COM)}" diaginertia="2.375e-6 2.375e-6 7.5e-7"/>'
        f'<joint name="robot/finger_{side}" type="slide" axis="0 1 0" range="0 {FINGER_TRAVEL}" armature="0.1" damping="10" '
        f'solreflimit="0.004 1" solimplimit="0.95 0.99 0.001"/>'
        f"{_visual('finger', visual)}{geoms}</body>"
    )


def _hand(visual: bool) -> str:
    """The hand's body with palm boxes, tool point, wrist sensor site and both fingers."""
    bits = f'contype="{ROBOT_BIT | SELF_BIT}" conaffinity="0"'
    palm = "".join(
        f'<geom class="col" {bits} type="box" pos="{_numbers(centre)}" size="{_numbers(half)}"/>'
        for centre, half in PALM_BOXES
    )
    turn = _exact((math.cos(HAND_TURN / 2), 0, 0, math.sin(HAND_TURN / 2)))
    return (
        f'<body name="robot/hand" pos="0 0 {FLANGE_OFFSET}" quat="{turn}" gravcomp="1">'
        f'<inertial mass="{HAND_MASS}" pos="{_numbers(HAND_COM)}" diaginertia="0.001 0.0025 0.0017"/>'
        f"{_visual('hand', visual)}{palm}"
        f'<site name="robot/wrist" group="4"/><site name="robot/tcp" pos="0 0 {TCP_OFFSET}" group="4"/>'
        f'<site name="robot/hand_com" pos="{_numbers(hand_com())}" group="4"/>'
        f"{_finger('left', '1 0 0 0', visual)}{_finger('right', '0 0 0 1', visual)}</body>"
    )


def hand_mass() -> float:
    """Mass carried by the wrist sensor with an empty hand [kg]."""
    return HAND_MASS + 2 * FINGER_MASS


def hand_com() -> tuple[float, float, float]:
    """Centre of mass of hand and fingers in the hand frame [m]; the fingers' part is symmetric about x = y = 0."""
    finger_z = FINGER_OFFSET + FINGER_COM[2]
    total = hand_mass()
    return (
        HAND_MASS * HAND_COM[0] / total,
        0.0,
        (HAND_MASS * HAND_COM[2] + 2 * FINGER_MASS * finger_z) / total,
    )


def panda_body(visual: bool = False) -> str:
    """MJCF of the arm's body tree with the hand, standing at the world's origin."""
    text = f'<body name="robot/link0">{_visual("link0", visual)}'
    text += _capsule(BASE_CAPSULE, f'contype="{ROBOT_BIT}" conaffinity="{SELF_BIT}"')
    for number, link in enumerate(LINKS, start=1):
        # Craig DH: translate a along x, turn alpha about x, translate d along the new z.
        position = (link.a, -link.d * math.sin(link.alpha), link.d * math.cos(link.alpha))
        turn = (math.cos(link.alpha / 2), math.sin(link.alpha / 2), 0.0, 0.0)
        contype = ROBOT_BIT | (SELF_BIT if number >= DISTAL else 0)
        bits = f'contype="{contype}" conaffinity="{SELF_BIT if number <= PROXIMAL else 0}"'
        text += (
            f'<body name="robot/link{number}" pos="{_exact(position)}" quat="{_exact(turn)}" gravcomp="1">'
            f'<inertial mass="{link.mass}" pos="{_numbers(link.com)}" fullinertia="{_numbers(link.inertia)}"/>'
            f'<joint name="robot/joint_{number}" axis="0 0 1" range="{_numbers(link.range)}" '
            f'actuatorfrcrange="{-link.torque} {link.torque}" armature="0.1" damping="0.5"/>'
            f"{_visual(f'link{number}', visual)}" + "".join(_capsule(ends, bits) for ends in link.capsules)
        )
    return text + _hand(visual) + "</body>" * 8


def _exact(values: tuple[float, ...]) -> str:
    """Full double precision: the model's forward kinematics must agree with the analytic one to the last digits."""
    return " ".join(repr(float(value)) for value in values)


def panda_defaults() -> str:
    """MJCF default classes "vis", "col" and "pad"."""
    contact = 'condim="4" group="3" mass="0"'
    return (
        '<default class="vis"><geom type="mesh" contype="0" conaffinity="0" group="2" rgba="0.93 0.93 0.95 1" mass="0"/>'
        "</default>"
        f'<default class="col"><geom {contact} friction="{PAD_FRICTION} 0.003 0.0001" rgba="0.85 0.86 0.88 1"/></default>'
        f'<default class="pad"><geom {contact} friction="{PAD_FRICTION} 0.004 0.0001" rgba="0.15 0.15 0.16 1"/></default>'
    )


def panda_assets(visual: bool = False) -> str:
    """MJCF mesh assets for pictures; empty for physics."""
    if not visual:
        return ""
    import sysconfig

    folder = Path(sysconfig.get_paths()["purelib"]).joinpath(*MESH_FOLDER)
    names = ["link0", *(f"link{number}" for number in range(1, 8)), "hand", "finger"]
    return "".join(f'<mesh name="{name}" file="{folder / name}.stl"/>' for name in names)


def panda_actuators() -> str:
    """MJCF tendon, finger coupling and actuators.

    Control inputs: for each joint (position [rad], velocity [rad/s], torque [N m]), then the opening [m]. The gripper
    acts on q1 + q2, so its force is the normal force of each finger [N].
    """
    arm = "".join(
        f'<pid name="robot/motor_{number}" joint="robot/joint_{number}" kp="{KP[number - 1]}" kv="{KV[number - 1]}" '
        f'input="pos vel ff" forcerange="{-link.torque} {link.torque}"/>'
        for number, link in enumerate(LINKS, start=1)
    )
    return (
        '<tendon><fixed name="robot/opening"><joint joint="robot/finger_left" coef="1"/>'
        '<joint joint="robot/finger_right" coef="1"/></fixed></tendon>'
        '<equality><joint joint1="robot/finger_left" joint2="robot/finger_right" solref="0.004 1" '
        'solimp="0.95 0.99 0.001"/></equality>'
        f'<actuator>{arm}<pid name="robot/gripper" tendon="robot/opening" kp="{GRIP_KP}" kv="{GRIP_KV}" input="pos" '
        f'forcerange="-20 20" slewmax="{GRIP_SLEW}"/></actuator>'
    )


def panda_sensors() -> str:
    """MJCF sensors of the robot itself: encoders, motor forces, opening, wrist wrench, tool pose and acceleration.

    Tool pose and accelerations (less gravity, in the hand frame) are what forward kinematics gives from the joint
    encoders.
    """
    numbers = range(1, 8)
    joints = "".join(f'<jointpos name="robot/joint_position/{n}" joint="robot/joint_{n}"/>' for n in numbers)
    speeds = "".join(f'<jointvel name="robot/joint_velocity/{n}" joint="robot/joint_{n}"/>' for n in numbers)
    torques = "".join(f'<actuatorfrc name="robot/joint_torque/{n}" actuator="robot/motor_{n}"/>' for n in numbers)
    return (
        joints + speeds + torques + '<tendonpos name="robot/opening" tendon="robot/opening"/>'
        '<tendonvel name="robot/opening_speed" tendon="robot/opening"/>'
        '<actuatorfrc name="robot/grip_force" actuator="robot/gripper"/>'
        '<force name="robot/wrist_force" site="robot/wrist"/><torque name="robot/wrist_torque" site="robot/wrist"/>'
        '<framepos name="robot/tcp_position" objtype="site" objname="robot/tcp"/>'
        '<framequat name="robot/tcp_quaternion" objtype="site" objname="robot/tcp"/>'
        '<accelerometer name="robot/hand_acceleration" site="robot/hand_com"/>'
        '<accelerometer name="robot/tcp_acceleration" site="robot/tcp"/>'
    )
