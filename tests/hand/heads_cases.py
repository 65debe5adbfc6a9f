"""Sample data of the head types and of arm 45: the manual's parameter tables and a pose from readable values."""

from __future__ import annotations

import random

from .kin_heads import FORMULAS
from .kin_heads_base import Conv, Matrix, Params

AXIS_COUNT = {
    **dict.fromkeys((17, 18), 3),
    **dict.fromkeys((3, 4, 5, 6, 7, 8, 30, 207), 4),
    **dict.fromkeys((2, 9, 10, 11, 16, 22, 25, 28, 33, 59, 60, 76), 5),
    **dict.fromkeys((45, 70), 6),
}
# HD numbers of the manual's tables, by what the file holds: lengths, angles, flags or plain numbers.
LENGTHS: dict[int, tuple[int, ...]] = {
    2: (1, 2, 3), 3: (1, 2, 3), 4: (1, 2, 3), 5: (1, 2, 3, 4, 7, 8), 6: (2, 3, 7, 8, 9, 10),
    7: (1, 2, 5, 6, 7, 8), 8: (2, 3, 7, 8, 9, 10), 9: (1, 2, 5, 6, 7, 8, 9), 10: (2, 3, 7, 8, 9, 10), 11: (1, 2),
    16: (1, 2, 3, 4, 5, 6), 17: (1, 2, 5, 6, 7, 8), 18: (2, 3, 7, 8, 9, 10), 22: (1,), 25: (1, 2, 5, 6, 7, 8, 9),
    28: (1, 2, 5, 6, 7, 8, 9), 30: (1, 2, 3, 6, 7, 8), 33: (4, 5, 6), 45: (1, 2, 3, 7, 8, 9, 10, 11, 12, 32),
    59: (1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13), 60: (1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13),
    70: (1, 2, 3, 4, 5, 6), 76: (1, 8, 9, 10), 207: (2, 3, 7, 8, 9, 10, 11),
}  # fmt: skip
ANGLES: dict[int, tuple[int, ...]] = {
    5: (5,), 6: (4,), 7: (3, 4), 8: (4, 5), 9: (3, 4), 10: (4, 5), 11: (3,), 16: (7, 8), 17: (3, 4), 18: (4, 5),
    25: (3, 4), 28: (3, 4, 11), 30: (5,), 33: (3,), 45: (4, 5, 6, 14, 15, 36, 37, 38, 39), 59: (7, 14, 15, 16, 17),
    60: (7, 14, 15), 70: (7, 8, 14), 207: (4, 5),
}  # fmt: skip
FLAGS: dict[int, dict[int, float]] = {
    16: {9: -1, 10: -1}, 22: {4: 1, 5: -1}, 28: {12: 3, 13: 7, 14: -1, 15: -1, 16: 2, 17: 5}, 30: {4: -1}, 33: {7: 1},
    45: {21: 1, 22: 1, 23: 1, 24: 1, 25: 1, 26: 1, 31: 1, 34: 5, 35: 1}, 70: {9: -1, 10: -1},
}  # fmt: skip
# Values the pose must not depend on: the gear of 28 (programmed angles), the unused one of HD2 and HD3 of 5.
SILENT = {(28, n) for n in (11, 12, 13, 16, 17)} | {(5, 2)}


def sample(kin: int, seed: int = 7) -> tuple[Params, list[float]]:
    """Returns full raw parameters and axis values of a type, all different and small enough for every domain."""
    rng = random.Random(1000 * kin + seed)
    param: Params = {n - 1: 1e4 * rng.uniform(20, 200) for n in LENGTHS[kin]}
    param |= {n - 1: 1e4 * rng.uniform(8, 16) for n in ANGLES.get(kin, ())}
    param |= {n - 1: float(value) for n, value in FLAGS.get(kin, {}).items()}
    if kin in (59, 60, 11, 33):
        param[2 if kin in (11, 33) else 6] = 41e4
    if kin == 5:
        param[4] = 97e4
    if kin == 207:
        param[3] = 70e4
    axes = [rng.uniform(-300, 300) for _ in range(min(3, AXIS_COUNT[kin]))]
    axes += [rng.uniform(15, 40) for _ in range(AXIS_COUNT[kin] - len(axes))]
    if kin == 45:
        axes = [rng.uniform(-80, 80) for _ in range(6)]
    return param, axes


def pose(kin: int, axes: list[float], length: float = 0.0, conv: Conv | None = None, /, **hd: float) -> Matrix:
    """Returns a pose from HD values given in mm and degrees as `HD1=...`; flags as `raw20=...` by HD number."""
    param = {int(k[2:]) - 1: v * 1e4 for k, v in hd.items() if k.startswith("HD")}
    param |= {int(k[3:]) - 1: v for k, v in hd.items() if k.startswith("raw")}
    return FORMULAS[kin](param, axes, length, conv or {})
