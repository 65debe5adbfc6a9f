"""A chain unrolled for closed forms: one sequence of screws from the workpiece to the tool.

Seen from the workpiece, T_workpiece_tool = exp(s1·q1) · … · exp(sn·qn) · M. The joints of the workpiece branch come
first, the one next to the workpiece leading, with their directions reversed; joints that do not move are part of the
constants.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Indices, Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import BASE_LINK, Chain, Joint, JointKind
from chainbuild.frames import inverse, transform
from chainbuild.ik.branches.core.subproblems import rotation
from chainbuild.kinematics.mechanism import Mechanism

Solution = tuple[Vector, tuple[bool, ...]]  # joint values in the order of the screws, and which of them are free
ArmSolver = Callable[[Matrix, Sequence[float]], list[Solution]]  # (target (4, 4), values to keep) → solutions

_SAMPLES: Final = 4  # a factor that is 0 in one position by chance is not in all


def transformed_point(T: Matrix, point: Vector) -> Vector:
    """Return where a rigid motion (4, 4) takes a point (3,)."""
    moved: Vector = T[:3, :3] @ point + T[:3, 3]
    return moved


@dataclass(frozen=True, slots=True, eq=False)
class Screw:
    """A joint that moves, at the zero of all moving joints.

    Attributes:
        kind: Revolute or prismatic.
        direction: (3,) unit vector in the workpiece frame.
        point: (3,) a point on the axis [m].
        joint: Index in `Chain.joints`.
        sense: -1 if the joint counts against the direction that its recipe draws, else +1.
    """

    kind: JointKind
    direction: Vector
    point: Vector
    joint: int
    sense: float = 1.0

    def T(self, value: float) -> Matrix:
        """Return the (4, 4) motion of a joint value."""
        if self.kind == "prismatic":
            return transform(None, value * self.direction)
        R = rotation(self.direction, value)
        return transform(R, self.point - R @ self.point)

    def reversed(self) -> Screw:
        """Return the joint that moves the other way."""
        return Screw(self.kind, -self.direction, self.point, self.joint, self.sense)

    def transformed(self, T: Matrix) -> Screw:
        """Return the joint moved by a rigid motion (4, 4)."""
        return Screw(self.kind, T[:3, :3] @ self.direction, transformed_point(T, self.point), self.joint, self.sense)

    def move(self, value: float, point: Vector) -> Vector:
        """Return where the motion of a joint value takes a point."""
        if self.kind == "prismatic":
            return point + value * self.direction
        moved: Vector = rotation(self.direction, value) @ (point - self.point) + self.point
        return moved


def rotation_seen_from(screws: Sequence[Screw], values: Sequence[float], R: Matrix) -> Matrix:
    """Return a rotation (3, 3) as seen from behind screws."""
    for screw, value in zip(screws, values, strict=True):
        if screw.kind == "revolute":
            R = rotation(screw.direction, -value) @ R
    return R


@dataclass(frozen=True, slots=True, eq=False)
class Serial:
    """Screws from the workpiece to the tool, and the pose at their zero.

    Attributes:
        screws: In the order of the product.
        M: (4, 4) tool in the workpiece frame where all moving joints are 0.
    """

    screws: tuple[Screw, ...]
    M: Matrix

    def pose(self, values: Vector) -> Matrix:
        """Return the (4, 4) pose at the moving joints' values, in the order of the screws."""
        T = np.eye(4)
        for screw, value in zip(self.screws, values, strict=True):
            T = T @ screw.T(float(value))
        return T @ self.M

    def reversed(self) -> Serial:
        """Return the chain from the tool to the workpiece: T⁻¹ = exp(−sn'·qn) · … · exp(−s1'·q1) · M⁻¹."""
        back = inverse(self.M)
        return Serial(tuple(screw.transformed(back).reversed() for screw in reversed(self.screws)), back)


@dataclass(frozen=True, slots=True, eq=False)
class AxisStructure:
    """Which axes move which joints, for one choice of held axes.

    Attributes:
        free: Axes that may move.
        linear: Free axes that move no revolute joint.
        rotary: The other free axes.
        moving: Joints between workpiece and tool that free axes move, in chain order.
        revolute: Those of `moving` that turn.
    """

    free: Indices
    linear: Indices
    rotary: Indices
    moving: Indices
    revolute: Indices


def axis_structure(mechanism: Mechanism, fixed: NDArray[np.bool_]) -> AxisStructure:
    """Return the structure of a robot with some axes fixed, prepared at first use.

    Args:
        mechanism: The mechanism.
        fixed: (n_axes,) True for held axes.
    """
    return mechanism.prepared("structure of free axes", lambda: _prepare(mechanism, fixed), fixed.tobytes())


def _prepare(mechanism: Mechanism, fixed: NDArray[np.bool_]) -> AxisStructure:
    chain = mechanism.chain
    between = _path(chain, "tool") ^ _path(chain, "workpiece")
    driven = _driven(mechanism)
    free = np.flatnonzero(~fixed)
    moving = [n for n, joint in enumerate(chain.joints) if joint.child in between and driven[n, free].any()]
    revolute = [n for n in moving if chain.joints[n].kind == "revolute"]
    turns = driven[revolute][:, free].any(axis=0)
    return AxisStructure(free, free[~turns], free[turns], _indices(moving), _indices(revolute))


def _indices(values: list[int]) -> Indices:
    return np.array(values, dtype=np.intp)


def _driven(mechanism: Mechanism) -> NDArray[np.bool_]:
    """Return (n_q, n_axes): True where a joint depends on an axis."""
    axis_map = mechanism.chain.axis_map
    if isinstance(axis_map, AffineMap):
        driven: NDArray[np.bool_] = axis_map.A != 0.0
        return driven
    rng = np.random.default_rng(0)
    lower = np.array([max(axis.lower, -100.0) for axis in mechanism.axes])
    upper = np.array([min(axis.upper, 100.0) for axis in mechanism.axes])
    seen = np.zeros((len(mechanism.chain.joints), len(mechanism.axes)), dtype=bool)
    for share in np.linspace(0.1, 0.4, _SAMPLES):
        values = lower + (upper - lower) * (0.5 + share * (rng.random(len(lower)) - 0.5))
        seen |= axis_map.dq_daxes(values) != 0.0
    return seen


def _path(chain: Chain, frame: str) -> frozenset[str]:
    """Return the links from the base (not counted) to a frame."""
    return frozenset(joint.child for joint in _branch(chain, frame))


def _branch(chain: Chain, frame: str) -> list[Joint]:
    """Return the joints from the base to a frame."""
    above = {joint.child: joint for joint in chain.joints}
    link, joints = chain.frame(frame).link, []
    while link != BASE_LINK:
        joints.append(above[link])
        link = above[link].parent
    return joints[::-1]


_MAX_SERIALS: Final = 64  # a held axis makes a chain of its own for every value


def unrolled(mechanism: Mechanism, q: Vector, moving: Indices) -> Serial:
    """Return `unroll` of a robot's chain, cached for the values of the constant joints."""
    constant = np.ones(len(q), dtype=bool)
    constant[moving] = False
    key = moving.tobytes() + q[constant].tobytes()
    return mechanism.prepared("serial", lambda: unroll(mechanism.chain, q, moving), key, _MAX_SERIALS)


def unroll(chain: Chain, q: Vector, moving: Indices) -> Serial:
    """Return the chain as screws.

    Args:
        chain: A checked chain.
        q: (n_q,) joint values; those of the moving joints are ignored.
        moving: Joints that move; the others are constants.
    """
    moves = {chain.joints[n].child for n in moving}
    index = {joint.child: n for n, joint in enumerate(chain.joints)}
    placed = {BASE_LINK: np.eye(4)}
    for n, joint in enumerate(chain.joints):
        T = placed[joint.parent] @ joint.T_parent_joint
        if joint.child not in moves:
            T = T @ Screw(joint.kind, joint.direction, np.zeros(3), n).T(float(q[n]))
        placed[joint.child] = T
    tips = [chain.frame(tip) for tip in ("workpiece", "tool")]
    T_base_workpiece, T_base_tool = (placed[tip.link] @ tip.T_link_frame for tip in tips)
    T_workpiece_base = inverse(T_base_workpiece)

    def screw(joint: Joint, sign: float) -> Screw:
        T = T_workpiece_base @ placed[joint.child]
        direction, sense = sign * (T[:3, :3] @ joint.direction), -1.0 if joint.reversed else 1.0
        return Screw(joint.kind, direction, T[:3, 3], index[joint.child], sense)

    workpiece, tool = _branch(chain, "workpiece"), _branch(chain, "tool")
    row = [screw(joint, -1.0) for joint in reversed(workpiece) if joint.child in moves]
    row += [screw(joint, 1.0) for joint in tool if joint.child in moves]
    return Serial(tuple(row), T_workpiece_base @ T_base_tool)
