"""An arm as six screws in plain NumPy: independent of chainbuild and of every solver that is compared.

T(q) = exp(s1·q1) … exp(s6·q6)·M; screws in the base frame at joint values 0. All of it over arrays of joint values.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np

SPHERICAL, PARALLEL, OTHER = "spherical wrist", "three parallel axes", "other"
CLASSES: Final = (SPHERICAL, PARALLEL, OTHER)
LENGTHS: Final = 1e-3  # share: what a calibration changes of lengths of 1 m is in the order of 1 mm
ANGLES: Final = np.radians(0.1)  # rad: likewise of the directions of axes
ZERO: Final = 1e-4  # share of the arm's length: what becomes of a length of zero, which no factor changes


@dataclass(frozen=True, eq=False)
class Arm:
    """Six rotary axes.

    Attributes:
        name: Its name; "… calibrated" where it was.
        family: One of `CLASSES`; a calibrated arm keeps that of the nominal one.
        calibrated: Whether lengths and directions are off the nominal ones.
        axes: (6, 3) unit directions at joint values 0.
        points: (6, 3) a point on each axis [m].
        M: (4, 4) tool in the base frame at joint values 0 [m].
    """

    name: str
    family: str
    calibrated: bool
    axes: np.ndarray
    points: np.ndarray
    M: np.ndarray

    @cached_property
    def length(self) -> float:
        """Length [m] that makes positions comparable with angles: from axis to axis to the tool, summed."""
        return float(np.linalg.norm(self.offsets(), axis=1)[1:].sum())

    def offsets(self) -> np.ndarray:
        """Return (7, 3) what leads from the base to the first point, from point to point, and to the tool [m]."""
        return np.diff(np.vstack([np.zeros(3), self.points, self.M[:3, 3]]), axis=0)

    @cached_property
    def _skew(self) -> tuple[np.ndarray, np.ndarray]:
        K = np.zeros((6, 3, 3))
        x, y, z = self.axes.T
        K[:, 2, 1], K[:, 0, 2], K[:, 1, 0] = x, y, z
        K -= K.transpose(0, 2, 1)
        return K, K @ K

    def kinematics(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return rotations (n, 3, 3), positions (n, 3) and Jacobians (n, 6, 6) for joint values (n, 6) [rad].

        Columns of a Jacobian: how the tool's point moves [m/rad], then how it turns, both in the base frame.
        """
        K, K2 = self._skew
        R, t = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
        turns, places = [], []
        for i, offset in enumerate(self.offsets()[:6]):
            t = t + R @ offset
            turns.append(R @ self.axes[i])
            places.append(t)
            sine, versine = np.sin(q[:, i])[:, None, None], 1.0 - np.cos(q[:, i])[:, None, None]
            R = R + R @ (sine * K[i] + versine * K2[i])
        t = t + R @ self.offsets()[6]
        w = np.stack(turns, axis=2)
        J = np.concatenate([np.cross(w, t[:, :, None] - np.stack(places, axis=2), axis=1), w], axis=1)
        return R @ self.M[:3, :3], t, J

    def pose(self, q: Sequence[float] | np.ndarray) -> np.ndarray:
        """Return the tool (4, 4) [m] at joint values (6,) [rad]."""
        R, t, _ = self.kinematics(np.asarray(q, dtype=float)[None])
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R[0], t[0]
        return T


def errors(arm: Arm, q: np.ndarray, T: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what is left to poses (n, 4, 4) [m] as vectors (n, 3) of position and turn [m, rad], and the Jacobians."""
    R, t, J = arm.kinematics(q)
    return T[:, :3, 3] - t, turn_vectors(T[:, :3, :3] @ R.transpose(0, 2, 1)), J


def turn_vectors(R: np.ndarray) -> np.ndarray:
    """Return the rotation vectors (n, 3) [rad] of rotations (n, 3, 3)."""
    v = 0.5 * np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    sine = np.linalg.norm(v, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(R, axis1=1, axis2=2) - 1.0))
    # Half a turn leaves no direction in v: any will do, the descent leaves that position at once.
    lost = (sine < 1e-9) & (angle > 1.0)
    v[lost] = np.array([np.pi, 0.0, 0.0])
    near = sine < 1e-9
    return v * np.where(near, 1.0, angle / np.where(near, 1.0, sine))[:, None]


def rotation(v: np.ndarray) -> np.ndarray:
    """Return the rotation (3, 3) about a vector (3,) [rad]."""
    angle = float(np.linalg.norm(v))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = v / angle
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


def calibrated(arm: Arm) -> Arm:
    """Return the arm with each component of its lengths × (1 ± 1e-3) and each link turned by ± 0.1° about x, y and z.

    Components of zero become ± 1e-4 of the arm's length: no three axes meet or are parallel any more. The draw is
    seeded by the name of the arm.
    """
    rng = np.random.default_rng(zlib.crc32(arm.name.encode()))

    def off(offset: np.ndarray) -> np.ndarray:
        change = np.where(np.abs(offset) < 1e-9, ZERO * arm.length, LENGTHS * offset)
        return offset + change * rng.uniform(-1.0, 1.0, 3)

    R, t = np.eye(3), np.zeros(3)
    axes, points = [], []
    for offset, axis in zip(arm.offsets()[:6], arm.axes, strict=True):
        t = t + R @ off(offset)
        R = R @ rotation(rng.uniform(-ANGLES, ANGLES, 3))
        axes.append(R @ axis)
        points.append(t)
    M = np.eye(4)
    M[:3, 3] = t + R @ off(arm.offsets()[6])
    M[:3, :3] = R @ arm.M[:3, :3]
    return Arm(f"{arm.name} calibrated", arm.family, True, np.array(axes), np.array(points), M)


def prebuilt_arm(name: str, kinematic_class: str, module: Any) -> Arm:
    """Return an arm of `ssik.prebuilt` from the matrices of its module: joint i is T_left · Rot(axis, q) · T_right."""
    T = np.eye(4)
    axes, points = [], []
    for left, axis, right in zip(module._JOINT_T_LEFTS, module._JOINT_AXES, module._JOINT_T_RIGHTS, strict=True):
        T = T @ left
        axes.append(T[:3, :3] @ axis / np.linalg.norm(axis))
        points.append(T[:3, 3].copy())
        T = T @ right
    family = SPHERICAL if SPHERICAL in kinematic_class else PARALLEL if "parallel" in kinematic_class else OTHER
    return Arm(name.removesuffix("_ik"), family, False, np.array(axes), np.array(points), T)
