"""Closed loops in Pinocchio: how far a state is from closing, and what still moves there.

Every loop is a ball between two frames: their points meet (`PointAnchorConstraintModel`). The constraint data belong to
this file alone: without `computeJointJacobians` and `calc` before it a constraint's Jacobian is wrong without a word.
"""

from __future__ import annotations

from collections.abc import Sequence
from threading import local
from typing import Final

import eigenpy
import numpy as np
import pinocchio as pin

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.bodies.linkage import rod_loops
from chainbuild.chain.closing import drawn_range
from chainbuild.chain.elements import Loop
from chainbuild.errors import ChainError
from chainbuild.kinematics.mechanism import Mechanism

_STEPS: Final = 20  # Newton steps: from a nearby state 3 or 4 do
_CLOSED: Final = 1e-13  # m: rounding of a metre
_RANK: Final = 1e-9  # share of the largest singular value below which one counts as 0
_TRIES: Final = 50  # axis values drawn for a closed state where the map does not know where it closes


class _Scratch(local):
    """Constraints with their working memory, each thread's own: one by one, and in the lists that Pinocchio takes."""

    def __init__(self, balls: Sequence[pin.PointAnchorConstraintModel]) -> None:
        self.models, self.datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        for ball in balls:
            self.models.append(pin.ConstraintModel(ball))
            self.datas.append(self.models[-1].createData())
        self.pairs = list(zip(self.models, self.datas, strict=True))
        self.read = [made.extract() for made in self.datas]


class Closure:
    """The loops of one mechanism.

    Args:
        mechanism: The mechanism.
        loops: Loops of kind "ball" between its frames; None: those of its chain.

    Raises:
        ChainError: a loop is of another kind.
    """

    def __init__(self, mechanism: Mechanism, loops: Sequence[Loop] | None = None) -> None:
        self.mechanism, self._model = mechanism, mechanism.model
        closed = mechanism.chain.loops if loops is None else loops
        self._scratch = _Scratch([self._ball(self._model, loop) for loop in closed])
        self._free = np.array(self.passive, dtype=np.intp)

    @staticmethod
    def _ball(model: pin.Model, loop: Loop) -> pin.PointAnchorConstraintModel:
        if loop.kind != "ball":
            raise ChainError(f"loop {loop.name} is a {loop.kind}: only balls close here; a hinge is two of them")
        ends = [model.frames[model.getFrameId(frame)] for frame in (loop.frame_a, loop.frame_b)]
        joints = [end.parentJoint for end in ends]
        return pin.PointAnchorConstraintModel(model, joints[0], ends[0].placement, joints[1], ends[1].placement)

    def error(self, q: Vector) -> tuple[Vector, Matrix]:
        """Return the gaps (3·loops,) [m] at joint values (n_q,), and their derivative (3·loops, n_q)."""
        model, data, scratch = self._model, self.mechanism.kinematics.data, self._scratch
        pin.computeJointJacobians(model, data, q)
        for one, made in scratch.pairs:
            one.calc(model, data, made)
        errors = np.concatenate([made.constraint_position_error for made in scratch.read])
        rows: Matrix = pin.getConstraintsJacobian(model, data, scratch.models, scratch.datas)
        return errors, rows

    def gap(self, q: Vector) -> float:
        """Return the largest gap [m] between ends that should meet."""
        errors, _ = self.error(q)
        return float(np.linalg.norm(errors.reshape(-1, 3), axis=1).max())

    def polished(self, q: Vector, moving: Vector | None = None) -> Vector:
        """Return joint values near given ones at which the loops close, by Newton's method.

        Args:
            q: (n_q,) joint values to start from.
            moving: Indices of the joints that may move; None: the passive ones, which no axis drives alone.

        Raises:
            ChainError: they do not close near there.
        """
        free = self._free if moving is None else np.asarray(moving, dtype=np.intp)
        found = q.copy()
        for _ in range(_STEPS):
            errors, J = self.error(found)
            if max(map(abs, errors.tolist())) < _CLOSED:
                return found
            # Loops in a plane have three rows of rank two: the factorisation has to find out.
            found[free] -= eigenpy.CompleteOrthogonalDecomposition(J.take(free, axis=1)).solve(errors)
        if self.gap(found) > _CLOSED * 1e3:
            raise ChainError(f"the loops do not close: a gap of {self.gap(found):.3g} m is left")
        return found

    @property
    def passive(self) -> tuple[int, ...]:
        """Indices of the joints that no axis drives alone."""
        axes = {axis.name for axis in self.mechanism.axes}
        return tuple(n for n, joint in enumerate(self.mechanism.chain.joints) if joint.name not in axes)

    def mobility(self, q: Vector) -> int:
        """Return how many freedoms the closed state at joint values (n_q,) has: joints less the rank of the loops."""
        _, J = self.error(q)
        values = np.linalg.svd(J, compute_uv=False)
        return self.mechanism.model.nv - int((values > _RANK * values[0]).sum())


def closure_of(mechanism: Mechanism) -> Closure:
    """Return the loops of a mechanism, made once."""
    return mechanism.prepared("closure", lambda: Closure(mechanism))


def check_closure(mechanism: Mechanism, seed: int = 3) -> None:
    """Refuse a chain whose loops do not close, or leave other freedoms than its axes, at a random closed state.

    Rods that are drawn with an arm's parallelogram and level linkage have to close, too.

    Raises:
        ChainError: they do not; a state that closes was found but contradicts the axes.
    """
    if rods := rod_loops(mechanism.chain):
        lower, upper = np.array([axis.range for axis in mechanism.axes]).T
        axes = lower + (upper - lower) * np.random.default_rng(seed).random(len(lower))
        _refuse_gap(Closure(mechanism, rods), mechanism.q(axes))
    if not mechanism.chain.loops:
        return
    rows = closing_axes(mechanism, np.random.default_rng(seed), 1)
    if not len(rows):
        return  # nothing closes within the limits: whoever asks for a pose is told
    q = mechanism.q(rows[0])
    closure = closure_of(mechanism)
    _refuse_gap(closure, q)
    freedoms = closure.mobility(q)
    if freedoms != len(mechanism.axes):
        text = f"the loops of {mechanism.chain.name} leave {freedoms} freedoms for {len(mechanism.axes)} axes"
        raise ChainError(text)


def _refuse_gap(closure: Closure, q: Vector) -> None:
    gap = closure.gap(q)
    if gap > _CLOSED * 1e3:
        name = closure.mechanism.chain.name
        raise ChainError(f"the loops of {name} do not close: a gap of {gap:.3g} m is left")


def closing_axes(mechanism: Mechanism, rng: np.random.Generator, count: int) -> Matrix:
    """Return up to `count` random axis values (n, n_axes) inside the limits at which a mechanism has a pose.

    Axes of closed loops that nobody limits are drawn where their struts let them stand. Chains whose map knows where it
    closes are drawn there; others are drawn from the box of their limits, and what has no pose is thrown away. The rows
    are fewer where hardly anything closes.

    Args:
        mechanism: Any mechanism, with loops or without.
        rng: Random numbers.
        count: Rows wanted.
    """
    lower, upper = drawn_range(mechanism.chain)
    axis_map = mechanism.chain.axis_map
    found: list[Vector] = []
    for _ in range(_TRIES * count):
        if len(found) == count:
            break
        axes = random_axis_values(axis_map, rng, lower, upper)[0]
        inside = bool(((axes >= lower) & (axes <= upper)).all()) and not mechanism.limits.breaks_together(axes)
        if inside and np.isfinite(axis_map.q(axes)).all():
            found.append(axes)
    return np.array(found).reshape(-1, len(lower))
