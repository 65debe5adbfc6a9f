"""The smallest singular value along straight axes, with a bound of its rate.

A singular value changes by no more than the Jacobian does: |σ(J + D) - σ(J)| ≤ |D|. In the tool frame the column of
joint i changes only by the joints j between it and the tool, each by dq_j times

    turn i, turn j     (a_j × v_i + v_j × a_i,  a_j × a_i)     shifts at most r_i + r_j, turns at most 1
    turn i, shift j    (a_j × a_i, 0)                          at most 1
    shift i, turn j    (a_j × a_i, 0)                          at most 1

r is the largest distance of the tool point from the joint's line: all offsets behind it added up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chainbuild.analysis.singularity.jacobians import pose_jacobians
from chainbuild.analysis.singularity.measures import Scaling, least_of, scaling_of
from chainbuild.analysis.vanishing.tracing import Blocks
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Chain
from chainbuild.chain.fold import drawn, drawn_values
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.screws import joints_between_tips


@dataclass(frozen=True, slots=True, eq=False)
class SmallestValue:
    """The smallest scaled singular value along blocks of straight axes, traced.

    Attributes:
        robot: The robot.
        rows: (N + 1, n_axes) axis values, mm and degrees.
        scaling: That of its task.
        threshold: Below it the value is low.
        rates: (N,) bound of the value's rate over each block.
        length: Step [share of a block] where the rate has no bound; 0: it has one.
    """

    robot: Mechanism
    rows: Matrix
    scaling: Scaling
    threshold: float
    rates: Vector
    length: float = 0.0

    @classmethod
    def along(cls, robot: Mechanism, rows: Matrix, threshold: float, sampled: float) -> SmallestValue:
        """Return the value along the blocks between rows.

        Args:
            robot: The robot.
            rows: (N + 1, n_axes) axis values.
            threshold: Below it the value is low.
            sampled: Step [share of a block] where the axis map is not affine and no bound is known.
        """
        scaling = scaling_of(robot)
        if not isinstance(robot.chain.axis_map, AffineMap):
            return cls(robot, rows, scaling, threshold, np.zeros(len(rows) - 1), sampled)
        return cls(robot, rows, scaling, threshold, jacobian_rates(robot, rows, scaling))

    def axes(self, blocks: Blocks, t: Vector) -> Matrix:
        """Return the axis values (n, n_axes) at shares of blocks."""
        return self.rows[blocks] + t[:, None] * (self.rows[blocks + 1] - self.rows[blocks])

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return how far the smallest singular values (n,) are above the threshold."""
        return self.sizes(blocks, t) - self.threshold

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the smallest singular values (n,); inf where there is no pose."""
        found = np.empty(len(blocks))
        for part, _, J in pose_jacobians(self.robot, self.axes(blocks, t)):
            scaled = self.scaling.apply(J)
            without = ~np.isfinite(scaled.reshape(len(scaled), -1)).all(axis=1)
            scaled[without] = 0.0
            smallest = least_of(np.linalg.svd(scaled, compute_uv=False), bool(self.robot.chain.loops))
            smallest[without] = np.inf
            found[part] = smallest
        return found

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return the shares over which the value changes by less than the margins."""
        if self.length:
            return np.full(len(blocks), self.length)
        rates = self.rates[blocks]
        return np.divide(margins, rates, out=np.ones(len(blocks)), where=rates > 0.0)


def jacobian_rates(robot: Mechanism, rows: Matrix, scaling: Scaling) -> Vector:
    """Return bounds (N,) of the rate of the scaled Jacobian, Frobenius norm, over the blocks between rows.

    Args:
        robot: A robot whose axis map is affine.
        rows: (N + 1, n_axes) axis values, mm and degrees.
        scaling: The Jacobian's.
    """
    chain = robot.chain
    axis_map = chain.axis_map
    assert isinstance(axis_map, AffineMap)
    q = axis_map.q_rows(rows)
    moved = np.abs(np.diff(q, axis=0))
    order = joints_between_tips(chain)
    reach = _reach(robot, np.abs(drawn_values(chain.joints, q)).max(axis=0), order)
    turning = np.array([joint.kind == "revolute" for joint in chain.joints])
    columns = np.zeros((len(moved), len(chain.joints)))
    for place, i in enumerate(order):
        for j in order[place + 1 :]:
            if turning[i] and turning[j]:
                rate = np.hypot((reach[i] + reach[j]) / scaling.length, 1.0)
            elif turning[i] or turning[j]:
                rate = 1.0 / scaling.length
            else:
                continue
            columns[:, i] += moved[:, j] * rate
    linear = np.array([axis.kind == "linear" for axis in robot.axes])
    per_axis = columns @ np.abs(axis_map.A) * np.where(linear, scaling.length, 1.0)
    return np.asarray(np.linalg.norm(per_axis[:, scaling.columns], axis=1))


def _reach(robot: Mechanism, largest: Vector, order: tuple[int, ...]) -> Vector:
    """Return (n_q,) how far the tool point can be from each joint's line [m].

    Args:
        robot: The robot.
        largest: (n_q,) largest absolute joint values as drawn: what linear joints add.
        order: Joints from the workpiece to the tool.
    """
    chain = robot.chain
    above = _above(chain, chain.frame("tool").link)
    reach = np.zeros(len(chain.joints))
    beyond = float(np.linalg.norm(chain.frame("tool").T_link_frame[:3, 3]))
    for n in reversed(order):
        joint = chain.joints[n]
        own = float(largest[n]) if joint.kind == "prismatic" else 0.0
        offset = float(np.linalg.norm(drawn(joint).T_parent_joint[:3, 3]))
        # Up the branch of the tool a joint lies at the end of its link, down that of the workpiece at its begin.
        reach[n] = beyond + own + (0.0 if n in above else offset)
        beyond += own + offset
    return reach


def _above(chain: Chain, link: str) -> set[int]:
    """Return the joints that carry a link."""
    carriers = {joint.child: n for n, joint in enumerate(chain.joints)}
    found: set[int] = set()
    while link in carriers:
        found.add(carriers[link])
        link = chain.joints[carriers[link]].parent
    return found
