"""The nearest singularity, by damped steps down the smallest singular value.

With u, v its singular vectors, the derivative of the smallest singular value by axis i is uᵀ·(∂J/∂xᵢ)·v. A Newton step
along it, −σ·g/(g·g), lands on the singular set up to second order. Of closed loops 1 over the largest singular value is
followed where it is the lesser one; its derivative is −uᵀ·(∂J/∂xᵢ)·v/σ². It falls as the root of the distance to the
edge of what closes, so that half of that step lands there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.singularity.measures import Scaling, jacobian_at, scaling_of
from chainbuild.arrays import Matrix, Vector
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import numbers_shown, two_lines

_STEPS: Final = 40  # Newton's need about ten, the bound ends those that go round in a circle
_FOUND: Final = 1e-11  # smallest singular value that counts as singular
# Of central differences of J: error 1e-10, by truncation and by rounding; the shorter ones where little more closes.
_DIFFERENCES: Final = (1e-5, 1e-7, 1e-9, 1e-11)
_LONGEST_STEP: Final = 0.3  # rad, or share of the length
_FLAT: Final = 1e-14  # squared slope below the error of the differences: there is no way down
_HALVINGS: Final = 6  # 1/64 of a step that does not get nearer either is given up


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """The nearest singularity found.

    Attributes:
        found: Whether the descent ended at a singularity; else `axes` is where it stopped.
        axes: (n_axes,) axis values there, mm and degrees.
        change: (n_axes,) motion of the axes to it, mm and degrees.
        distance: Length of that motion in rad, linear axes as a share of the characteristic length.
        smallest: Smallest scaled singular value there.
        steps: Steps taken.
        inside: Whether it is inside the limits.
    """

    found: bool
    axes: Vector
    change: Vector
    distance: float
    smallest: float
    steps: int
    inside: bool

    def __repr__(self) -> str:
        what = "found" if self.found else "none found"
        where = f"at {numbers_shown(self.axes)}, {'inside' if self.inside else 'outside'} the limits"
        return two_lines(
            f"<Nearest {what} {where}; change {numbers_shown(self.change)} [mm, deg]; {self.distance:.3g} rad>"
        )


def nearest_singularity(
    robot: Mechanism, axes: ArrayLike, *, length: float | None = None, inside: bool = False
) -> Nearest:
    """Return the singularity that a descent from axis values (n_axes,), mm and degrees, ends at.

    The descent follows the steepest fall of the smallest scaled singular value: a local search, which finds the
    singularity that the position is already close to. Limits are not kept; the result says whether it is inside.

    Args:
        robot: The robot.
        axes: Axis values to start from.
        length: Characteristic length [m]; None: the default.
        inside: True: the search is given up where it leaves the limits.

    Raises:
        AxisValueError: wrong number of values, or a non-finite value.
        ChainbuildError: the kinematic has no pose there.
    """
    jacobian_at(robot, axes)  # raises where there is no pose
    descent = _Descent(robot, scaling_of(robot, length), robot.axis_values(axes))
    return descent.run(inside)


@dataclass(frozen=True, slots=True, eq=False)
class _Value:
    """What is followed: its size, u and v with which uᵀ·∂J·v is its derivative, the share of a step that is taken."""

    size: float
    u: Vector
    v: Vector
    share: float = 1.0


class _Descent:
    """One search in scaled coordinates z: radians, and linear axes as a share of the length."""

    def __init__(self, robot: Mechanism, scaling: Scaling, axes: Vector) -> None:
        self.robot, self.scaling = robot, scaling
        linear = np.array([robot.axes[n].kind == "linear" for n in scaling.columns])
        self.unit = np.where(linear, scaling.length, 1.0)
        self.x0 = axes * robot.kinematics.si_factors

    def x(self, z: Vector) -> Vector:
        x: Vector = self.x0.copy()
        x[self.scaling.columns] += z * self.unit
        return x

    def jacobian(self, z: Vector) -> Matrix:
        return self.scaling.apply(self.robot.kinematics.pose_and_jacobian(self.x(z))[1])

    def smallest(self, z: Vector) -> _Value:
        """Return the value at z."""
        J = self.jacobian(z)
        if not np.isfinite(J).all():  # no pose: farther than any singularity
            return _Value(math.inf, np.zeros(len(J)), np.zeros(J.shape[1]))
        U, values, Vt = np.linalg.svd(J, full_matrices=False)
        least, most = float(values[-1]), float(values[0])
        if self.robot.chain.loops and least * most > 1.0:
            return _Value(1.0 / most, -U[:, 0] / most**2, Vt[0], share=0.5)
        return _Value(least, U[:, -1], Vt[-1])

    def run(self, inside: bool) -> Nearest:
        z = np.zeros(len(self.unit))
        value = self.smallest(z)
        steps = 0
        while value.size > _FOUND and steps < _STEPS:
            steps += 1
            step = self._step(z, value)
            if step is None:
                break
            for _ in range(_HALVINGS):
                tried = self.smallest(z + step)
                if tried.size < value.size:
                    break
                step = step / 2.0
            else:
                break
            z = z + step
            value = tried
            if inside and self.robot.violated_limits(self.x(z) / self.robot.kinematics.si_factors):
                break
        return self._result(z, value, steps)

    def _step(self, z: Vector, value: _Value) -> Vector | None:
        gradient = self._gradient(z, value.u, value.v)
        squared = 0.0 if gradient is None else float(gradient @ gradient)
        if gradient is None or squared < _FLAT:
            return None
        step = -value.share * value.size * gradient / squared
        size = float(np.linalg.norm(step))
        shorter: Vector = step * min(1.0, _LONGEST_STEP / size)
        return shorter

    def _gradient(self, z: Vector, u: Vector, v: Vector) -> Vector | None:
        """Return uᵀ·(∂J/∂zᵢ)·v, or None on the edge of what has a pose."""
        for difference in _DIFFERENCES:
            steps = difference * np.eye(len(z))
            changes = [self.jacobian(z + h) - self.jacobian(z - h) for h in steps]
            if np.isfinite(changes).all():
                return np.array([float(u @ change @ v) for change in changes]) / (2.0 * difference)
            if not self.robot.chain.loops:
                break
        return None

    def _result(self, z: Vector, value: _Value, steps: int) -> Nearest:
        factors = self.robot.kinematics.si_factors
        axes = self.x(z) / factors
        inside = not self.robot.violated_limits(axes)
        change = axes - self.x0 / factors
        # The verdict must not depend on the last bit of a step; a root of 1e-10 is as near as 1e-10 is.
        found = value.size < (1e-7 if value.share == 1.0 else 1e-5)
        return Nearest(found, axes, change, float(np.linalg.norm(z)), value.size, steps, inside)
