"""The motion between rows: axes straight, or the tip on a line.

`ptp`: every axis changes evenly. `cp`: the tip moves along a straight line and the tool turns about one axis; machines
programmed by position and rotary axes keep those even instead, and their linear axes alone follow from the line.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.path.linesolve import (
    LARGEST_LINE_STEP,
    LINE_DAMPING,
    LINE_MET,
    LINE_STEPS,
    jacobians_at,
    newton_steps,
    rates_for,
    struts_at,
    unscaled,
)
from chainbuild.analysis.singularity.measures import scaling_of
from chainbuild.analysis.vanishing.functions import singular_functions
from chainbuild.analysis.vanishing.line import LineBlocks
from chainbuild.analysis.vanishing.tracing import Blocks
from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.rtcp import linear_axes_batch
from chainbuild.kinematics.inputs import as_pose
from chainbuild.kinematics.mechanism import Mechanism

Between = Literal["ptp", "cp", "rows"]
BETWEEN: Final = ("ptp", "cp", "rows")  # in the order of the help

_GAUSS: Final = np.polynomial.legendre.leggauss(8)  # exact for lengths that vary as a polynomial of degree 15
_WALK: Final = 32  # steps from a row to a place that the straight axes do not lead to
_BRANCH: Final = 1e-6  # of functions of about 1: next to 0 what Newton leaves open decides the sign
_SINGLY: Final = 8  # places up to which Pinocchio is quicker one by one than NumPy at once


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
        if keeps_rotary_axes(robot):
            return SlidingMotion(robot, rows, poses[:, :3, 3])
        return LineMotion(robot, rows, LineBlocks.between(poses))
    raise ChainbuildError(f"unknown motion '{between}'", parameter="between", permitted="ptp, cp, rows")


def keeps_rotary_axes(robot: Mechanism) -> bool:
    """Return whether rotary axes are programmed on lines (RTCP): they change evenly, linear axes or struts follow."""
    chain = robot.chain
    return chain.solves_linear_axes or bool(chain.loops and chain.display.rtcp and chain.display.axes)


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
        J = jacobians_at(self.robot, self.axes(blocks, t))
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
        even, positions = _between_rows(self.rows, blocks, t), _between_rows(self.positions, blocks, t)
        if self.robot.chain.loops:
            return struts_at(self.robot, positions, even)
        found = linear_axes_batch(self.robot, positions, even)
        return np.where((found.position_error <= LINE_MET)[:, None], found.axes, np.nan)

    def speeds(self, blocks: Blocks, t: Vector) -> tuple[Matrix, Vector, Vector]:
        """Return axes, tip and turn over a block at their speed there."""
        factors, solved = self.robot.kinematics.si_factors, list(self.robot.chain.display.solved)
        ways = (self.rows[blocks + 1] - self.rows[blocks]) * factors
        ways[:, solved] = 0.0
        axes = self.axes(blocks, t)
        J = jacobians_at(self.robot, axes)
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
        missed |= self._crossed(x, blocks)
        doubtful = missed | (np.abs(x - straight).max(axis=1, initial=0.0) > LARGEST_LINE_STEP)
        for end in (0, 1):
            if doubtful.any() and not self._fewer:
                rows = np.flatnonzero(doubtful)
                walked, met = self._walked(blocks[rows], t[rows], end)
                met &= ~self._crossed(walked, blocks[rows])
                x[rows[met]] = walked[met]
                missed[rows[met]] = doubtful[rows[met]] = False
        for n in np.flatnonzero(missed & ~np.array(self._fewer)):
            branch = self._branch(straight[n], int(blocks[n]), float(t[n]))
            if branch is not None:
                x[n], missed[n] = branch, False
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

    def _branch(self, straight: Vector, block: int, t: float) -> Vector | None:
        """Return axis values in SI of the branch that both rows are of, the one nearest to straight ones, or None.

        Between a singularity and the next one, Newton's method from either row may end at the first.
        """
        if not singular_functions(self.robot).complete or self.robot.kinematics.affine is None:
            return None  # what is the branch of both rows is not known
        factors = self.robot.kinematics.si_factors
        found = ik_all(self.robot, self.lines.pose(block, t), straight / factors).axes * factors
        kept = found[~self._crossed(found, np.full(len(found), block))]
        return kept[np.abs(kept - straight).max(axis=1).argmin()] if len(kept) else None

    def _crossed(self, x: Matrix, blocks: Blocks) -> NDArray[np.bool_]:
        """Return which axis values in SI are of another branch than both rows of their block."""
        crossed = np.zeros(len(x), dtype=bool)
        known, affine = singular_functions(self.robot), self.robot.kinematics.affine
        if not known.complete or affine is None:
            return crossed
        factors = self.robot.kinematics.si_factors
        for function in known.functions:
            ends, here = (
                np.cos((values @ affine.A.T + affine.b) @ function.multiples.T + function.phases) @ function.amplitudes
                for values in (self.rows * factors, x)
            )
            before, behind = np.sign(ends[blocks]), np.sign(ends[blocks + 1])
            crossed |= (before == behind) & (here * before < -_BRANCH)
        return crossed

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
        for _ in range(LINE_STEPS):
            if not len(left):
                break
            steps, error[left] = newton_steps(self.robot, x[rows[left]], positions[left], rotations[left])
            going = error[left] > LINE_MET
            left = left[going]
            x[rows[left]] += steps[going]
        return np.asarray(error <= LINE_MET * 1e3)

    def _solve_one(self, x: Vector, block: int, t: float) -> bool:
        """Improve axis values x (n_axes,) in SI, in place, and return whether they meet the line: one by Pinocchio."""
        scaling, kinematics = scaling_of(self.robot), self.robot.kinematics
        residual = kinematics.residual(as_pose(self.lines.pose(block, t)), self.robot.task)
        lengths = np.where(scaling.rows < 3, scaling.length, 1.0)
        off = np.inf
        for _ in range(LINE_STEPS):
            error, J = residual(x)
            off = float(np.abs(error).max())
            if not off > LINE_MET:
                break
            whole = np.zeros((6, J.shape[1]))
            whole[scaling.rows] = J
            scaled = scaling.apply(whole)
            normal = scaled.T @ scaled + LINE_DAMPING * np.eye(scaled.shape[1])
            step = np.asarray(np.linalg.solve(normal, scaled.T @ (error / lengths)), dtype=float)
            largest = float(np.abs(step).max())
            step *= min(1.0, LARGEST_LINE_STEP / max(largest, LARGEST_LINE_STEP))
            x += unscaled(self.robot, scaling, step[None])[0]
        return off <= LINE_MET * 1e3

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
        found = rates_for(self.robot, axes, twist, evenly) / factors
        if self._fewer:
            even = self._from_straight(blocks, t)[2]  # there the axes stay even, whatever the line asks
            found[even] = evenly[even] / factors
        return found, *_sizes(ways, turns)

    def lengths(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the way of the tip."""
        ways = self.lines.ways[blocks]
        return _sizes(ways, ways)[0] * t
