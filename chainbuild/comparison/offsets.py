"""Constant offsets: their mean over many poses, and their text."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrices, Vector
from chainbuild.frames import ANGLE_MODES
from chainbuild.units import deg_from_rad, mm_from_m


def mean_transform(transforms: Matrices) -> NDArray[np.float64]:
    """Return the mean (4, 4) of rigid transforms (n, 4, 4); of the rotations the one nearest to all."""
    u, _, v = np.linalg.svd(transforms[:, :3, :3].mean(axis=0))
    T = np.eye(4)
    T[:3, :3] = u @ np.diag([1.0, 1.0, float(np.sign(np.linalg.det(u @ v)))]) @ v
    T[:3, 3] = transforms[:, :3, 3].mean(axis=0)
    return T


def distinct_angle_modes() -> list[list[str]]:
    """Return the names of the angle modes, those that mean the same in one list."""
    groups: dict[object, list[str]] = {}
    for name, mode in ANGLE_MODES.items():
        groups.setdefault(mode.factors, []).append(name)
    return list(groups.values())


def all_rigid(transforms: Matrices) -> bool:
    """Tell whether transforms (n, 4, 4) are rigid and right-handed."""
    R = transforms[:, :3, :3]
    return bool(np.abs(R @ np.transpose(R, (0, 2, 1)) - np.eye(3)).max() < 1e-6 and (np.linalg.det(R) > 0).all())


def mm_text(vector: Vector) -> str:
    """Return a vector [m] in mm, to the nanometre."""
    return "(" + ", ".join(f"{round(mm_from_m(float(v)), 6) + 0.0:.10g}" for v in vector) + ")"


def transform_text(T: NDArray[np.float64]) -> str:
    """Return a transform's shift and rotation angle as text."""
    vector = T[:3, 3]
    sine = math.sqrt(max(0.0, float(((T[:3, :3] - np.eye(3)) ** 2).sum()))) / math.sqrt(8.0)
    angle = deg_from_rad(2.0 * math.asin(min(1.0, sine)))
    turn = f", turned by {angle:.6g} deg" if angle > 1e-6 else ""
    return f"{mm_text(vector)} mm{turn}"
