"""The joints in a row from the base to a tip: their lines with every axis at 0, and what drives each.

Screws and Denavit-Hartenberg rows are read off these lines. A joint that closed loops move has no value that one could
state by an axis, and its tip no such row.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.poses import link_placements, path_to
from chainbuild.shown import fields_shown
from chainbuild.units import si_factor
from chainbuild.writers.machine_report.document.numbers import decimal

if TYPE_CHECKING:
    from chainbuild.arrays import Matrix, Vector
    from chainbuild.chain.elements import Chain, Joint
    from chainbuild.kinematics.mechanism import Mechanism

Tip = Literal["tool", "workpiece"]

_SLIGHT: Final = 1e-12  # factors below this are rounding of folded directions
_FACTOR_PLACES: Final = 12  # of a factor: a gear's may be no short decimal number


@dataclass(frozen=True, slots=True)
class DrivenJoint:
    """A joint of a row.

    Attributes:
        name: Its name.
        turns: Whether it turns; else it shifts.
        terms: What its value is a sum of, in degrees or mm: factor and the name of an axis or a joint value.
    """

    __repr__ = fields_shown

    name: str
    turns: bool
    terms: tuple[tuple[float, str], ...]

    def text(self, offset: float = 0.0, places: int = 6) -> str:
        """Return its value plus an offset as text: "A3 - A2 + 90"."""
        parts = [("-" if factor < 0.0 else "+", _term(abs(factor), name)) for factor, name in self.terms]
        constant = decimal(abs(offset), places)
        if constant != "0" or not parts:
            parts.append(("-" if offset < 0.0 and constant != "0" else "+", constant))
        (sign, first), *others = parts
        return " ".join([f"-{first}" if sign == "-" else first, *(f"{mark} {text}" for mark, text in others)])


def _term(factor: float, name: str) -> str:
    shown = decimal(factor, _FACTOR_PLACES)
    return name if shown == "1" else f"{shown}*{name}"


@dataclass(frozen=True, slots=True, eq=False)
class JointRow:
    """The joints from the base to a tip with their lines in the base, where every value is 0.

    Attributes:
        tip: The tip.
        joints: The joints.
        directions: (n, 3) unit vectors.
        points: (n, 3) a point of each line [m].
        T: (4, 4) the tip in the base [m].
    """

    __repr__ = fields_shown

    tip: Tip
    joints: tuple[DrivenJoint, ...]
    directions: Matrix
    points: Matrix
    T: Matrix


def named_by_joints(chain: Chain) -> bool:
    """Return whether rows are told by joint values, since a nonlinear map gives them by the axis values."""
    return not isinstance(chain.axis_map, AffineMap)


def joint_row(robot: Mechanism, tip: Tip) -> JointRow | None:
    """Return the joints from the base to a tip; None where closed loops move one of them."""
    chain = robot.chain
    frame = chain.frame(tip)
    path = path_to(chain, frame.link)
    index = {joint.name: n for n, joint in enumerate(chain.joints)}
    q = np.zeros(len(chain.joints))
    if isinstance(chain.axis_map, AffineMap):
        q = chain.axis_map.b
    elif chain.loops and not all(_own(robot, index[joint.name]) for joint in path):
        return None
    links = link_placements(chain, q)
    placed = [links[joint.parent] @ joint.T_parent_joint for joint in path]
    directions = [T[:3, :3] @ joint.direction for T, joint in zip(placed, path, strict=True)]
    # A slide's own value moves its link along its line, on which its point may then lie elsewhere: nothing changes.
    return JointRow(
        tip,
        tuple(
            DrivenJoint(joint.name, joint.kind == "revolute", _terms(chain, joint, index[joint.name])) for joint in path
        ),
        np.array(directions).reshape(-1, 3),
        np.array([T[:3, 3] for T in placed]).reshape(-1, 3),
        links[frame.link] @ frame.T_link_frame,
    )


def _terms(chain: Chain, joint: Joint, n: int) -> tuple[tuple[float, str], ...]:
    if not isinstance(chain.axis_map, AffineMap):
        names = [axis.name for axis in chain.axes]
        return ((1.0, joint.name if chain.loops and joint.name in names else f"q[{joint.name}]"),)
    own = si_factor("rotary" if joint.kind == "revolute" else "linear")
    factors = [
        (float(f) * si_factor(axis.kind) / own, axis.name)
        for f, axis in zip(chain.axis_map.A[n], chain.axes, strict=True)
        if abs(f) > _SLIGHT
    ]
    return tuple(factors)


def _own(robot: Mechanism, n: int) -> bool:
    """Return whether a joint of a machine with loops is driven by the axis of its name alone, 1:1."""
    chain = robot.chain
    names = [axis.name for axis in chain.axes]
    joint = chain.joints[n]
    if joint.name not in names:
        return False
    wanted: Vector = np.zeros(len(names))
    wanted[names.index(joint.name)] = 1.0
    at = robot.prepared("closed position", lambda: closed_position(robot))
    return at is not None and bool(np.abs(chain.axis_map.dq_daxes(at)[n] - wanted).max() < _SLIGHT)


def closed_position(robot: Mechanism) -> Vector | None:
    """Return axis values (n_axes,), mm and degrees, at which the loops close, or None where hardly anything does."""
    from chainbuild.analysis.workspace.mapspec import random_axes

    rows = random_axes(robot, np.random.default_rng(0), 16)
    return next((row for row in rows if np.isfinite(robot.chain.axis_map.q(row)).all()), None)
