"""The motion between rows: axes straight, or the tip on a line.

`ptp`: every axis changes evenly. `cp`: the tip moves along a straight line and the tool turns about one axis; machines
programmed by position and rotary axes keep those even instead, and their linear axes alone follow from the line.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.singularity.jacobians import pose_jacobians
from chainbuild.analysis.singularity.measures import Scaling, scaling_of
from chainbuild.analysis.vanishing.line import LineBlocks, rotation_vectors
from chainbuild.analysis.vanishing.tracing import Blocks
from chainbuild.arrays import Matrices, Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.ik.rtcp import linear_axes_batch
from chainbuild.kinematics.inputs import as_pose
from chainbuild.kinematics.mechanism import Mechanism

Between = Literal["ptp", "cp", "rows"]
BETWEEN: Final = ("ptp", "cp", "rows")  # in the order of the help

_GAUSS: Final = np.polynomial.legendre.leggauss(8)  # exact for lengths that vary as a polynomial of degree 15
_STEPS: Final = 12  # Newton steps along a line: from the straight axes 3 or 4 do, next to a singularity more
_DAMPING: Final = 1e-12  # of squared scaled singular values: holds steps finite where one is 0
_WALK: Final = 32  # steps from a row to a place that the straight axes do not lead to
_MET: Final = 1e-9  # m, rad: an axis value is off by less than a display shows
_LARGEST: Final = 0.3  # scaled step: beyond it a pose is not linear enough
_SINGLY: Final = 8  # places up to which Pinocchio is quicker one by one than NumPy at once
_LOST: Final = 1e-9  # scaled singular values below this are 0


class PathMotion(Protocol):
    """The motion along some blocks."""

    @property
    def robot(self) -> Mechanism:
        """The robot."""
        ...

    @property
    def rows(self) -> Matrix:
        """(N + 1, n_axes) axis values at the ends of the blocks, mm and degrees."""
        ...

    def axes(self, blocks: Blocks, t: Vector) -> Matrix:
        """Return the axis values (n, n_axes) at shares of blocks; not a number where none are found."""
        ...

    def speeds(self, blocks: Blocks, t: Vector) -> tuple[Matrix, Vector, Vector]:
        """Return what a block would be at its speed there: axes, tip and turn.

        Axes (n, n_axes) in mm and degrees, inf where a lost motion is asked of them; the way of the tip (n,) in mm, and
        the turn of the tool (n,) in degrees.
        """
        ...

    def lengths(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the way (n,) of the tip from the begin of a block to its share t, in mm."""
        ...


def motion_of(robot: Mechanism, rows: Matrix, between: Between) -> PathMotion:
    """Return the motion between rows (N + 1, n_axes).

    Raises:
        ChainbuildError: there is no such motion.
    """
    if between == "ptp":
        return StraightMotion(robot, rows)
    if between == "cp":
        poses = robot.fk_batch(rows)
        if robot.chain.solves_linear_axes:
            return SlidingMotion(robot, rows, poses[:, :3, 3])
        return LineMotion(robot, rows, LineBlocks.between(poses))
    raise ChainbuildError(f"unknown motion '{between}'", parameter="between", permitted="ptp, cp, rows")


def _jacobians(robot: Mechanism, axes: Matrix) -> Matrices:
    parts = [J for _, _, J in pose_jacobians(robot, axes)]
    return np.concatenate(parts) if parts else np.empty((0, 6, axes.shape[1]))


def _sizes(shifts: Matrix, turns: Matrix) -> tuple[Vector, Vector]:
    """Return the sizes of shifts (n, 3) [m] in mm and of turns (n, 3) [rad] in degrees."""
    return np.linalg.norm(shifts, axis=1) * 1000.0, np.degrees(np.linalg.norm(turns, axis=1))


def _between_rows(rows: Matrix, blocks: Blocks, t: Vector) -> Matrix:
    begins: Matrix = rows[blocks]
    return begins + t[:, None] * (rows[blocks + 1] - begins)


@dataclass(frozen=True, slots=True, eq=False)
class StraightMotion:
    """Axes that change evenly; see `PathMotion`."""

    robot: Mechanism
    rows: Matrix

    def axes(self, blocks: Blocks, t: Vector) -> Matrix:
        """Return the axis values at shares of blocks."""
        return _between_rows(self.rows, blocks, t)

    def speeds(self, blocks: Blocks, t: Vector) -> tuple[Matrix, Vector, Vector]:
        """Return axes, tip and turn over a block at their speed there."""
        ways = self.rows[blocks + 1] - self.rows[blocks]
        J = _jacobians(self.robot, self.axes(blocks, t))
        twist = np.einsum("nij,nj->ni", J, ways * self.robot.kinematics.si_factors)
        return ways, *_sizes(twist[:, :3], twist[:, 3:])

    def lengths(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the way of the tip, by Gauss's quadrature of its speed."""
        nodes, weights = _GAUSS
        shares = (t[:, None] * (nodes + 1.0) / 2.0).ravel()
        tips = self.speeds(np.repeat(blocks, len(nodes)), shares)[1]
        total: Vector = tips.reshape(len(t), len(nodes)) @ weights * t / 2.0
        return total


@dataclass(frozen=True, slots=True, eq=False)
class SlidingMotion:
    """The tip on a line, rotary axes even, linear axes as the line needs them; see `PathMotion`."""

    robot: Mechanism
    rows: Matrix
    positions: Matrix

    def axes(self, blocks: Blocks, t: Vector) -> Matrix:
        """Return the axis values at shares of blocks."""
        even = _between_rows(self.rows, blocks, t)
        found = linear_axes_batch(self.robot, _between_rows(self.positions, blocks, t), even)
        return np.where((found.position_error <= _MET)[:, None], found.axes, np.nan)

    def speeds(self, blocks: Blocks, t: Vector) -> tuple[Matrix, Vector, Vector]:
        """Return axes, tip and turn over a block at their speed there."""
        factors, solved = self.robot.kinematics.si_factors, list(self.robot.chain.display.solved)
        ways = (self.rows[blocks + 1] - self.rows[blocks]) * factors
        ways[:, solved] = 0.0
        axes = self.axes(blocks, t)
        J = _jacobians(self.robot, axes)
        R = self.robot.fk_batch(axes)[:, :3, :3]
        shift = self.positions[blocks + 1] - self.positions[blocks]
        missing = np.einsum("nji,nj->ni", R, shift) - np.einsum("nij,nj->ni", J[:, :3], ways)
        ways[:, solved] = np.einsum("nij,nj->ni", np.linalg.pinv(J[:, :3, solved]), missing)
        return ways / factors, *_sizes(shift, np.einsum("nij,nj->ni", J[:, 3:], ways))

    def lengths(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the way of the tip."""
        shift = self.positions[blocks + 1] - self.positions[blocks]
        return _sizes(shift, shift)[0] * t


@dataclass(frozen=True, slots=True, eq=False)
class LineMotion:
    """The tip on a line, the tool turning about one axis; see `PathMotion`."""

    robot: Mechanism
    rows: Matrix
    lines: LineBlocks

    def axes(self, blocks: Blocks, t: Vector) -> Matrix:
        """Return the axis values at shares of blocks, by Newton's method from the straight axes; limits are ignored."""
        x, straight, missed = self._from_straight(blocks, t)
        # Next to a singularity the straight axes may be too far, or lead to another branch: walk from the rows.
        doubtful = missed | (np.abs(x - straight).max(axis=1, initial=0.0) > _LARGEST)
        for end in (0, 1):
            if doubtful.any() and not self._fewer:
                rows = np.flatnonzero(doubtful)
                walked, met = self._walked(blocks[rows], t[rows], end)
                x[rows[met]] = walked[met]
                missed[rows[met]] = doubtful[rows[met]] = False
        return self._found(x, straight, missed)

    def direct(self, blocks: Blocks, t: Vector) -> Matrix:
        """Return the axis values as `axes` does, only from the straight axes: for samples, of which there are many."""
        return self._found(*self._from_straight(blocks, t))

    def near(self, block: int, t: float, start: Vector) -> Vector:
        """Return the axis values (n_axes,) at a place, from those of a place close by (n_axes,)."""
        x = start[None] * self.robot.kinematics.si_factors
        index, shares = np.array([block]), np.array([t])
        if self._solve(x, index, shares, np.zeros(1, dtype=np.intp))[0]:
            found: Vector = x[0] / self.robot.kinematics.si_factors
            return found
        elsewhere: Vector = self.axes(index, shares)[0]
        return elsewhere

    @property
    def _fewer(self) -> bool:
        """Whether the line has more freedoms than there are axes: the tool may not be able to turn as it does."""
        scaling = scaling_of(self.robot)
        return len(scaling.columns) < len(scaling.rows)

    def _found(self, x: Matrix, straight: Matrix, missed: NDArray[np.bool_]) -> Matrix:
        x[missed] = straight[missed] if self._fewer else np.nan
        found: Matrix = x / self.robot.kinematics.si_factors
        return found

    def _from_straight(self, blocks: Blocks, t: Vector) -> tuple[Matrix, Matrix, NDArray[np.bool_]]:
        """Return axis values in SI found from the straight axes, these, and which are not found."""
        even = _between_rows(self.rows, blocks, t) * self.robot.kinematics.si_factors
        x, missed = even.copy(), (t > 0.0) & (t < 1.0)
        missed[missed] = ~self._solve(x, blocks, t, np.flatnonzero(missed))
        return x, even, missed

    def _solve(self, x: Matrix, blocks: Blocks, t: Vector, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Improve some rows of axis values x in SI, in place, and return which of them meet the line."""
        if len(rows) <= _SINGLY:
            return np.array([self._solve_one(x[n], int(blocks[n]), float(t[n])) for n in rows], dtype=bool)
        positions, rotations = self.lines.poses(blocks[rows], t[rows])
        error, left = np.full(len(rows), np.inf), np.arange(len(rows))
        for _ in range(_STEPS):
            if not len(left):
                break
            steps, error[left] = _steps(self.robot, x[rows[left]], positions[left], rotations[left])
            going = error[left] > _MET
            left = left[going]
            x[rows[left]] += steps[going]
        return np.asarray(error <= _MET * 1e3)

    def _solve_one(self, x: Vector, block: int, t: float) -> bool:
        """Improve axis values x (n_axes,) in SI, in place, and return whether they meet the line: one by Pinocchio."""
        scaling, kinematics = scaling_of(self.robot), self.robot.kinematics
        residual = kinematics.residual(as_pose(self.lines.pose(block, t)), self.robot.task)
        lengths = np.where(scaling.rows < 3, scaling.length, 1.0)
        off = np.inf
        for _ in range(_STEPS):
            error, J = residual(x)
            off = float(np.abs(error).max())
            if not off > _MET:
                break
            whole = np.zeros((6, J.shape[1]))
            whole[scaling.rows] = J
            scaled = scaling.apply(whole)
            normal = scaled.T @ scaled + _DAMPING * np.eye(scaled.shape[1])
            step = np.asarray(np.linalg.solve(normal, scaled.T @ (error / lengths)), dtype=float)
            largest = float(np.abs(step).max())
            step *= min(1.0, _LARGEST / max(largest, _LARGEST))
            x += _unscaled(self.robot, scaling, step[None])[0]
        return off <= _MET * 1e3

    def _walked(self, blocks: Blocks, t: Vector, end: int) -> tuple[Matrix, NDArray[np.bool_]]:
        """Return axis values in SI found step by step from the begin (0) or the end (1) of blocks, and which are."""
        x = self.rows[blocks + end] * self.robot.kinematics.si_factors
        met = np.ones(len(blocks), dtype=bool)
        for n in range(1, _WALK + 1):
            left = np.flatnonzero(met)
            if not len(left):
                break
            met[left] = self._solve(x, blocks, end + (t - end) * n / _WALK, left)
        return x, met

    def speeds(self, blocks: Blocks, t: Vector) -> tuple[Matrix, Vector, Vector]:
        """Return axes, tip and turn over a block at their speed there."""
        factors = self.robot.kinematics.si_factors
        axes = self.axes(blocks, t)
        _, rotations = self.lines.poses(blocks, t)
        ways, turns = self.lines.ways[blocks], self.lines.turns[blocks]
        twist = np.concatenate([np.einsum("nji,nj->ni", rotations, ways), turns], axis=1)
        evenly = (self.rows[blocks + 1] - self.rows[blocks]) * factors
        found = _rates(self.robot, axes, twist, evenly) / factors
        if self._fewer:
            even = self._from_straight(blocks, t)[2]  # there the axes stay even, whatever the line asks
            found[even] = evenly[even] / factors
        return found, *_sizes(ways, turns)

    def lengths(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the way of the tip."""
        ways = self.lines.ways[blocks]
        return _sizes(ways, ways)[0] * t


def _steps(robot: Mechanism, x: Matrix, positions: Matrix, rotations: Matrices) -> tuple[Matrix, Vector]:
    """Return Newton's steps (n, n_axes) in SI towards poses, and how far off (n,) [m, rad] the tool is now."""
    scaling, factors = scaling_of(robot), robot.kinematics.si_factors
    axes = x / factors
    poses = robot.fk_batch(axes)
    back = np.swapaxes(poses[:, :3, :3], 1, 2)
    shift = np.einsum("nij,nj->ni", back, positions - poses[:, :3, 3])
    if robot.task == "pose":
        turn = rotation_vectors(back @ rotations)
    else:
        column = robot.chain.tool_column
        turn = np.cross(np.eye(3)[column], np.einsum("nij,nj->ni", back, rotations[:, :, column]))
    error = np.concatenate([shift, turn], axis=1)[:, scaling.rows]
    off = np.abs(error).max(axis=1)
    error[:, scaling.rows < 3] /= scaling.length
    J = scaling.apply(_jacobians(robot, axes))
    normal = np.swapaxes(J, 1, 2) @ J + _DAMPING * np.eye(J.shape[2])
    steps = np.linalg.solve(normal, np.swapaxes(J, 1, 2) @ error[:, :, None])[:, :, 0]
    largest = np.abs(steps).max(axis=1, keepdims=True)
    steps *= np.minimum(1.0, _LARGEST / np.maximum(largest, _LARGEST))
    return _unscaled(robot, scaling, steps), off


def _unscaled(robot: Mechanism, scaling: Scaling, steps: Matrix) -> Matrix:
    """Return steps of all axes in SI from scaled ones of those that move."""
    linear = np.array([robot.axes[n].kind == "linear" for n in scaling.columns])
    full = np.zeros((len(steps), len(robot.axes)))
    full[:, scaling.columns] = steps * np.where(linear, scaling.length, 1.0)
    return full


def _rates(robot: Mechanism, axes: Matrix, twist: Matrix, evenly: Matrix) -> Matrix:
    """Return the rates (n, n_axes) in SI that a twist needs; inf where it asks for a motion that is lost.

    Args:
        robot: The robot.
        axes: (n, n_axes) axis values; rows that are not numbers have no rates.
        twist: (n, 6) of the tool in its own frame, over a block.
        evenly: (n, n_axes) what the axes change over the block, SI: where `axes` starts from.
    """
    scaling = scaling_of(robot)
    known = np.asarray(np.isfinite(axes).all(axis=1))
    found = np.full(axes.shape, np.nan)
    if not known.any():
        return found
    J = _jacobians(robot, axes[known])
    given = evenly[known]  # what is left of the twist is made with least motion: it decides on redundant machines
    rest = (twist[known] - np.einsum("nij,nj->ni", J, given))[:, scaling.rows]
    rest[:, scaling.rows < 3] /= scaling.length
    U, values, Vt = np.linalg.svd(scaling.apply(J), full_matrices=False)
    along = np.einsum("nij,ni->nj", U, rest)
    lost = values < _LOST
    with np.errstate(divide="ignore", invalid="ignore"):
        solved = np.einsum("nij,ni->nj", Vt, np.where(lost, 0.0, along / values))
    endless = np.einsum("nij,ni->nj", np.abs(Vt), np.where(lost & (np.abs(along) > _LOST), 1.0, 0.0)) > _LOST
    rates = _unscaled(robot, scaling, solved) + given
    rates[:, scaling.columns] = np.where(endless, np.inf, rates[:, scaling.columns])
    found[known] = rates
    return found
