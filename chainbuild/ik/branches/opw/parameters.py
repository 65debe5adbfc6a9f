"""Parameters of an ortho-parallel arm with a spherical wrist, measured on the axes of a chain.

The seven lengths and the zero pose are those of Brandstötter, Angerer, Hofbaur 2014: at zero the arm points straight
up, axis 1 along z, axes 2, 3 and 5 along y, axes 4 and 6 along z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.frames import inverse
from chainbuild.ik.branches.arms.arms import wrist_centre
from chainbuild.ik.branches.arms.positioner import parallel
from chainbuild.ik.branches.core.serial import Serial

_RIGHT_ANGLE: Final = 1e-9  # cosine of axes at right angles, but for rounding


@dataclass(frozen=True, slots=True, eq=False)
class OpwArm:
    """An arm in the terms of its seven lengths.

    Attributes:
        parameters: a1, a2, b, c1, c2, c3, c4 [m].
        signs: (6,) joint value → angle from the zero pose.
        offsets: (6,) added after the sign [rad].
        T_base_arm: (4, 4) the arm's own base in the workpiece frame.
        T_flange_tool: (4, 4) tool on its sixth axis.
    """

    parameters: dict[str, float]
    signs: Vector
    offsets: Vector
    T_base_arm: Matrix
    T_flange_tool: Matrix

    def theta(self, joints: Vector) -> Vector:
        """Return angles from the zero pose of joint values [rad]."""
        angles: Vector = self.signs * joints + self.offsets
        return angles

    def joints(self, theta: Vector) -> Vector:
        """Return joint values of angles from the zero pose [rad]."""
        values: Vector = self.signs * (theta - self.offsets)
        return values

    def outward(self, T_arm_flange: Matrix) -> Matrix:
        """Return tool in the workpiece frame of the sixth axis in the arm's base."""
        return self.T_base_arm @ T_arm_flange @ self.T_flange_tool

    def inward(self, T_workpiece_tool: Matrix) -> Matrix:
        """Return the sixth axis in the arm's base of tool in the workpiece frame."""
        return inverse(self.T_base_arm) @ T_workpiece_tool @ inverse(self.T_flange_tool)


def opw_arm(serial: Serial) -> OpwArm | None:
    """Return the parameters of an arm, or None if it is not an ortho-parallel arm with a spherical wrist."""
    if len(serial.screws) != 6 or any(screw.kind != "revolute" for screw in serial.screws):
        return None
    # As drawn: the front side and the bend of the wrist do not depend on how the axes count.
    w = [screw.sense * screw.direction for screw in serial.screws]
    centre = wrist_centre(serial.screws[3:])
    crossing = ((0, 1), (2, 3), (3, 4), (4, 5))
    square = all(abs(float(w[i] @ w[j])) < _RIGHT_ANGLE for i, j in crossing)
    if centre is None or not square or not parallel(w[1], w[2]):
        return None
    return _measure(serial, w, centre)


def _measure(serial: Serial, w: list[Vector], centre: Vector) -> OpwArm:
    """Return the parameters of an arm whose axes are known to be those of an ortho-parallel one."""
    z, y = w[0], w[1]
    x = np.cross(y, z)
    origin = serial.screws[0].point - float(serial.screws[0].point @ z) * z
    axes = np.column_stack((x, y, z))
    shoulder, elbow, wrist = (axes.T @ (p - origin) for p in (serial.screws[1].point, serial.screws[2].point, centre))
    hand = w[3] if float((centre - serial.screws[2].point) @ w[3]) >= 0 else -w[3]
    upper = math.atan2(elbow[0] - shoulder[0], elbow[2] - shoulder[2])
    forearm = math.atan2(float(hand @ x), float(hand @ z))
    out = wrist - elbow
    across = np.array([math.cos(forearm), 0.0, -math.sin(forearm)])
    along = np.array([math.sin(forearm), 0.0, math.cos(forearm)])
    parameters = {
        "a1": float(shoulder[0]),
        "a2": float(out @ across),
        "b": float(wrist[1]),
        "c1": float(shoulder[2]),
        "c2": float(math.hypot(elbow[0] - shoulder[0], elbow[2] - shoulder[2])),
        "c3": float(out @ along),
        "c4": 0.0,
    }
    senses = np.array([screw.sense for screw in serial.screws])
    signs = np.array([1.0, 1.0, math.copysign(1.0, float(w[2] @ y)), math.copysign(1.0, float(w[3] @ hand)), 1.0, 1.0])
    fourth = math.atan2(float(hand @ np.cross(y, w[4])), float(y @ w[4]))
    fifth = math.atan2(float(w[4] @ np.cross(hand, w[5])), float(hand @ w[5]))
    offsets = np.array([0.0, upper, forearm - upper, fourth, fifth, 0.0])
    T_base_arm = np.eye(4)
    T_base_arm[:3, :3], T_base_arm[:3, 3] = axes, origin
    at_zero = _sixth_axis(parameters, offsets)
    return OpwArm(parameters, senses * signs, offsets, T_base_arm, inverse(T_base_arm @ at_zero) @ serial.M)


def _sixth_axis(p: dict[str, float], theta: Vector) -> Matrix:
    """Return the wrist frame in the arm's base, from the definition of the seven lengths."""

    def turn(axis: str, angle: float) -> Matrix:
        c, s = math.cos(angle), math.sin(angle)
        T = np.eye(4)
        i, j = (0, 1) if axis == "z" else (2, 0)
        T[i, i] = T[j, j] = c
        T[i, j], T[j, i] = -s, s
        return T

    def shift(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Matrix:
        T = np.eye(4)
        T[:3, 3] = x, y, z
        return T

    column = turn("z", theta[0]) @ shift(x=p["a1"], z=p["c1"]) @ turn("y", theta[1]) @ shift(z=p["c2"])
    arm = column @ turn("y", theta[2]) @ shift(x=p["a2"], y=p["b"], z=p["c3"])
    return arm @ turn("z", theta[3]) @ turn("y", theta[4]) @ shift(z=p["c4"]) @ turn("z", theta[5])
