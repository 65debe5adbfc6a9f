"""Hand formulas of KIN_TYP 91 and of the coupling manual's configurations, NumPy and math only; lists to feed them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

Matrix = np.ndarray


def shift(vector: Iterable[float]) -> Matrix:
    T = np.eye(4)
    T[:3, 3] = list(vector)
    return T


def rotation(direction: Sequence[float], angle_deg: float) -> Matrix:
    """Return the turn about a direction as 4×4, by Rodrigues' formula."""
    x, y, z = np.array(direction, dtype=float) / np.linalg.norm(direction)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(angle_deg)
    T = np.eye(4)
    T[:3, :3] += math.sin(angle) * K + (1 - math.cos(angle)) * (K @ K)
    return T


@dataclass
class AxisOf91:
    """An axis: 1 linear or 2 rotary, direction, point [mm]."""

    kind: int
    orientation: Sequence[float]
    point: Sequence[float] = (0.0, 0.0, 0.0)

    def motion(self, value: float) -> Matrix:
        if self.kind == 1:
            return shift(value * np.array(self.orientation, dtype=float))
        return shift(self.point) @ rotation(self.orientation, value) @ shift(-np.array(self.point, dtype=float))


@dataclass
class Universal:
    """KIN_TYP 91 in mm and degrees."""

    axes: Sequence[AxisOf91]
    chain: Sequence[int]
    zero_orientation: Sequence[float] = (0.0, 0.0, 1.0)
    zero_position: Sequence[float] = (0.0, 0.0, 0.0)
    rtcp: int = 1
    more: Sequence[str] = field(default_factory=tuple)

    def product(self, values: Sequence[float]) -> Matrix:
        T = np.eye(4)
        for k in self.chain:
            T = T @ self.axes[k].motion(values[k])
        return T

    def tip(self, values: Sequence[float], length_mm: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Return tool tip [mm] and tool vector."""
        T, o = self.product(values), np.array(self.zero_orientation) / np.linalg.norm(self.zero_orientation)
        end = np.array(self.zero_position) - length_mm * o
        return (T @ [*end, 1.0])[:3], T[:3, :3] @ o

    def lines(self, j: int = 0, prefix: str | None = None, name: str = "") -> list[str]:
        p = prefix or f"trafo[{j}]"
        out = [] if prefix and "kinematik" in prefix else [f"{p}.id 91"]
        if name:
            out.append(f"{p}.name {name}")
        out += [f"{p}.zero_orientation[{i}] {v!r}" for i, v in enumerate(map(float, self.zero_orientation))]
        out += [f"{p}.zero_position[{i}] {v * 1e4!r}" for i, v in enumerate(map(float, self.zero_position))]
        out.append(f"{p}.number_of_axes {len(self.axes)}")
        out += [f"{p}.chain[{k}] {n}" for k, n in enumerate(self.chain)]
        for k, axis in enumerate(self.axes):
            out.append(f"{p}.axis[{k}].type {axis.kind}")
            out += [f"{p}.axis[{k}].orientation[{i}] {float(v)!r}" for i, v in enumerate(axis.orientation)]
            out += [f"{p}.axis[{k}].point[{i}] {float(v) * 1e4!r}" for i, v in enumerate(axis.point)]
        return [*out, f"{p}.rtcp {self.rtcp}", *(f"{p}.{line}" for line in self.more)]

    def slots(self) -> list[str]:
        """Return the list with everything that has a PARAM[] slot there."""
        values = [*self.zero_orientation, *(v * 1e4 for v in self.zero_position), len(self.axes)]
        for axis in self.axes:
            values += [axis.kind, *axis.orientation, *(v * 1e4 for v in axis.point)]
        out = ["trafo[0].id 91", *(f"trafo[0].param[{k}] {float(v)!r}" for k, v in enumerate(values))]
        return [*out, *(f"trafo[0].chain[{k}] {n}" for k, n in enumerate(self.chain)), f"trafo[0].rtcp {self.rtcp}"]


def random_universal(rng: np.random.Generator, n: int, *, unit: bool = True) -> Universal:
    axes = []
    for k in range(n):
        o = rng.normal(size=3)
        axes.append(
            AxisOf91(1 if k < 3 else 2, tuple(o / np.linalg.norm(o) if unit else o), tuple(rng.normal(size=3) * 300))
        )
    order = tuple(int(k) for k in rng.permutation(n))
    return Universal(axes, order, tuple(rng.normal(size=3)), tuple(rng.normal(size=3) * 400))


X, Y, Z = AxisOf91(1, (1, 0, 0)), AxisOf91(1, (0, 1, 0)), AxisOf91(1, (0, 0, 1))
XY_UNIT = Universal([X, Y], [0, 1])
XZ_UNIT = Universal([X, Z], [0, 1])
TABLE = Universal([AxisOf91(2, (-1, 0, 0)), AxisOf91(2, (0, 0, -1))], [1, 0])
CA_HEAD = Universal(
    [X, Y, Z, AxisOf91(2, (0, 0, 1)), AxisOf91(2, (1, 0, 0), (0, 0, -100))], [0, 1, 2, 3, 4], (0, 0, 1), (0, 0, -250)
)

# KUKA KR 6 R900-2 as KIN_TYP 45: HD number → count.
ROBOT = {
    7: 4000000,
    8: 4550000,
    9: 4200000,
    10: 900000,
    11: 250000,
    12: -250000,
    14: -900000,
    15: 900000,
    21: 1,
    24: 1,
    26: 1,
}


def robot_lines(j: int, name: str = "ROBOT") -> list[str]:
    return [
        f"trafo[{j}].id 45",
        f"trafo[{j}].name {name}",
        *(f"trafo[{j}].param[{n - 1}] {v}" for n, v in ROBOT.items()),
    ]


def robot_pose(axes: Sequence[float]) -> Matrix:
    """Return the flange of that robot in its own coordinate system [mm] (KIN_TYP manual 3.3)."""
    c1, b1, b2, a1, b3, a2 = axes
    z, y, x = (0, 0, 1), (0, 1, 0), (1, 0, 0)
    parts = [
        rotation(z, -c1), shift((25, 0, 400)), rotation(y, b1 + 90), shift((0, 0, 455)), rotation(y, b2 - 90),
        shift((420, 0, 25)), rotation(x, -a1), rotation(y, b3), shift((90, 0, 0)), rotation(x, -a2), rotation(y, 90),
    ]  # fmt: skip
    T = np.eye(4)
    for part in parts:
        T = T @ part
    return T
