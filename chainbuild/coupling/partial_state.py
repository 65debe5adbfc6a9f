"""State of a partial kinematic during distribution: freedoms, held coordinates, current values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Chain, Partial
from chainbuild.chain.names import axis_index, generic_name
from chainbuild.chain.poses import angle_rates, pose, pose_jacobian, rotation_vector
from chainbuild.errors import AxisValueError
from chainbuild.units import m_from_mm, mm_from_m

LETTERS: Final = "XYZABC"
TURNS: Final = slice(3, 6)
_SHIFTS: Final = slice(0, 3)
_STEPS: Final = 30  # Newton steps on up to three angles: converges in a few
_SAME_DEG: Final = 1e-9  # angles closer than this are the same, but for rounding
# Freedoms are determined off the middle of the limits: a stretched arm, or an upright head, has lost some.
_GENERIC: Final = (0.537, 0.461, 0.523, 0.444, 0.571, 0.489)
_RANK: Final = 1e-7  # share of the largest singular value: below is rounding, freedoms are far above


@dataclass(frozen=True, slots=True, eq=False)
class PartialFreedoms:
    """Freedoms of the tool frame of a partial, in the coordinates of its own system.

    Attributes:
        chain: The partial.
        letters: Coordinates that it can move one at a time, of X, Y, Z, A, B, C.
        directions: (3, k) orthonormal directions that it can shift along.
    """

    chain: Chain
    letters: str
    directions: Matrix

    @classmethod
    def of(cls, chain: Chain) -> PartialFreedoms:
        """Determine the freedoms of a chain in a generic position."""
        shares = np.resize(_GENERIC, len(chain.axes))
        axes = np.array([a.lower + s * (a.upper - a.lower) for a, s in zip(chain.axes, shares, strict=True)])
        U, values, _ = np.linalg.svd(pose_jacobian(chain, axes))
        reach = U[:, : int((values > _RANK * values[0]).sum())]
        _, sines, Vt = np.linalg.svd(reach[3:])
        still = Vt[int((sines > _RANK).sum()) :].T
        directions = reach[:3] @ still
        free = [_within(directions, np.eye(3)[n]) for n in range(3)]
        if directions.shape[1] == sum(free):
            directions = np.eye(3)[:, free]  # exactly, so that held coordinates keep their last digit
        R = pose(chain, axes)[:3, :3]
        rates = angle_rates(chain.angle_mode, frames.angles_from_matrix(chain.angle_mode, R))
        free += [_within(reach, np.concatenate([np.zeros(3), rates[:, n]])) for n in range(3)]
        return cls(chain, "".join(letter for letter, yes in zip(LETTERS, free, strict=True) if yes), directions)

    def directions_without(self, held: Iterable[str]) -> Matrix:
        """Return (3, k) the orthonormal directions that keep some of X, Y, Z."""
        rows = [LETTERS.index(letter) for letter in held if letter in "XYZ"]
        if not rows or not self.directions.size:
            return self.directions
        _, values, Vt = np.linalg.svd(self.directions[rows])
        result: Matrix = self.directions @ Vt[int((values > _RANK).sum()) :].T
        return result

    def at_rest(self, axes: Mapping[str, float]) -> Vector:
        """Return the six values with all axes at 0 except those named; free coordinates are 0."""
        values = np.array([axes.get(axis.name, 0.0) for axis in self.chain.axes])
        T = pose(self.chain, values)
        angles = frames.angles_from_matrix(self.chain.angle_mode, T[:3, :3])
        found = np.array([*(mm_from_m(float(value)) for value in T[:3, 3]), *angles])
        found[:3] -= self.directions @ (self.directions.T @ found[:3])
        for letter in self.letters:
            found[LETTERS.index(letter)] = 0.0
        return found


def _within(space: Matrix, vector: Vector) -> bool:
    """Return whether a vector lies in the span of orthonormal columns."""
    return float(np.linalg.norm(vector - space @ (space.T @ vector))) < _RANK * float(np.linalg.norm(vector))


def as_transform(mode: str, values: Vector) -> Matrix:
    """Return (4, 4) [m] of X, Y, Z [mm], A, B, C [degrees] in an angle mode."""
    position = [m_from_mm(float(value)) for value in values[_SHIFTS]]
    return frames.transform(frames.matrix_from_angles(mode, values[TURNS].tolist()), position)


@dataclass(slots=True, eq=False)
class State:
    """A partial during distribution.

    Attributes:
        partial: The partial.
        freedoms: Its freedoms.
        now: (6,) its values, mm and degrees.
        held: Letters that keep their values.
        rest: Axis name → value of programmed axes that are not Cartesian freedoms.
    """

    partial: Partial
    freedoms: PartialFreedoms
    now: Vector
    held: set[str] = field(default_factory=set)
    rest: dict[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, partial: Partial) -> State:
        """Return a partial at rest."""
        freedoms = PartialFreedoms.of(partial.chain)
        return cls(partial, freedoms, freedoms.at_rest({}), {*partial.locked})

    def program(self, name: str, value: float) -> None:
        """Give a coordinate, or the axis that stands for it, a value that the distribution does not touch.

        Raises:
            AxisValueError: the partial cannot move in it.
        """
        letter = self.coordinate(name)
        if letter in self.freedoms.letters:
            self.now[LETTERS.index(letter)] = value
            self.held.add(letter)
            return
        n = axis_index(self.partial.chain.axes, name)
        if n is None:
            text = f"{self.partial.name} cannot be moved in {name} by itself"
            raise AxisValueError(text, parameter=f"{self.partial.name}.{name}", permitted=self.permitted())
        # An axis whose motion is not a freedom of the tool frame: all coordinates that are not free follow it.
        self.rest[self.partial.chain.axes[n].name] = value
        fixed = [n for n, known in enumerate(LETTERS) if known not in self.freedoms.letters]
        self.now[fixed] = self.freedoms.at_rest(self.rest)[fixed]

    def coordinate(self, name: str) -> str:
        """Return the coordinate that a name means: its letter, or an axis of the partial by any of its names.

        While the partial is coupled, its axes stand for coordinates. What is neither is returned as it is.
        """
        n = None if name in LETTERS else axis_index(self.partial.chain.axes, name)
        if n is None:
            return name
        letter = (self.partial.letters or [generic_name(axis) for axis in self.partial.chain.axes])[n]
        return letter if letter in LETTERS else name

    def hold(self, name: str) -> None:
        """Keep a coordinate, given by its letter or by the axis that stands for it, at its value.

        Raises:
            AxisValueError: there is no such coordinate.
        """
        letter = self.coordinate(name)
        if letter not in LETTERS:
            raise AxisValueError(
                f"there is no coordinate {letter}",
                parameter=f"{self.partial.name}.{letter}",
                permitted=", ".join(LETTERS),
            )
        self.held.add(letter)

    def permitted(self) -> str:
        """Return what can be programmed."""
        names = [*self.freedoms.letters, *(axis.name for axis in self.partial.chain.axes)]
        return ", ".join(dict.fromkeys(names))

    @property
    def T(self) -> Matrix:
        """(4, 4) the tool frame in the partial's own system [m]."""
        return as_transform(self.partial.chain.angle_mode, self.now)

    @property
    def T_below(self) -> Matrix:
        """(4, 4) the tool frame in that of the partial below [m]."""
        return self.partial.T_carrier_mcs @ self.T

    def turn(self, R: Matrix, angles: Vector | None) -> None:
        """Take as much of a rotation as the free angles allow.

        Args:
            R: The requested rotation.
            angles: The same as angles, if known exactly.
        """
        mode = self.partial.chain.angle_mode
        free = [n for n in range(3) if "ABC"[n] in self.freedoms.letters and "ABC"[n] not in self.held]
        if not free:
            return
        now = self.now[TURNS]
        wanted = np.array(frames.angles_from_matrix(mode, R) if angles is None else angles)
        others = [n for n in range(3) if n not in free]
        away = np.remainder(wanted[others] - now[others] + 180.0, 360.0) - 180.0
        if np.abs(away).max(initial=0.0) < _SAME_DEG:
            now[free] = wanted[free]
            return
        for _ in range(_STEPS):
            error = rotation_vector(R @ frames.matrix_from_angles(mode, now.tolist()).T)
            step = np.degrees(np.linalg.lstsq(angle_rates(mode, now.tolist())[:, free], error, rcond=1e-9)[0])
            now[free] += step
            if float(np.abs(step).max()) < tolerances.RIGHT_ANGLE_DEG:
                break

    def shift(self, position: Vector) -> None:
        """Move towards a position [mm] as far as the free directions allow."""
        D = self.freedoms.directions_without(self.held)
        self.now[_SHIFTS] += D @ (D.T @ (position - self.now[_SHIFTS]))
