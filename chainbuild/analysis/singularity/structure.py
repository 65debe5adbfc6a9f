"""Structure of a chain from its joint lines: arms with elbow, shoulder and wrist; machines with a pole.

The kinematic's number is not used. The lines that the joints turn about, seen in two positions, tell which
joints are parallel and which meet in a wrist point, and from that follow the functions that vanish at singularities.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.singularity.measures import characteristic_length
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.elements import Chain
from chainbuild.kinematics.evaluation import usual_range
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.screws import joints_between_tips, screws_at

SingularityKind = Literal[
    "wrist", "elbow", "shoulder", "pole", "tilt_end", "strut", "platform", "twist", "other", "gimbal_lock", "dead_point"
]

_SAME: Final = 1e-9  # sines and shares of the length below this are 0: data carry 1e-4 mm at best
_PROBES: Final = 2  # two: what lines up in one position by chance does not in the other
_TRIES: Final = 50  # positions drawn for each of them: enough where a tenth of the range has poses


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """The lines of the joints at one position, all in the tool frame.

    Attributes:
        directions: (n_q, 3) direction of each joint.
        points: (n_q, 3) a point of each line [m]; 0 for linear joints.
    """

    directions: Matrix
    points: Matrix


@dataclass(frozen=True, slots=True)
class ArmForm:
    """An arm whose second and third rotary joints are parallel.

    Attributes:
        upper: Joint at the base of the upper arm.
        elbow: Joint parallel to it that follows.
        tip: Joints whose lines meet in the point that the elbow holds: one parallel to the elbow, or the wrist's.
        turn: Joint before the upper arm, across it; None if there is none, as in a SCARA.
        head: Joints whose lines meet in the point that matters at the shoulder.
        wrist: First and last of the last three joints, whose lines can become parallel; None for fewer joints.
    """

    upper: int
    elbow: int
    tip: tuple[int, ...]
    turn: int | None
    head: tuple[int, ...]
    wrist: tuple[int, int, int] | None


@dataclass(frozen=True, slots=True)
class CartesianForm:
    """A machine whose linear axes alone reach every point: only the rotary ones can be singular.

    Attributes:
        rotary: Rotary joints from the workpiece to the tool.
    """

    rotary: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class WristForm:
    """Anything with a central wrist whose basic axes have no known singularities.

    Attributes:
        joints: The last three rotary joints, whose lines meet.
    """

    joints: tuple[int, int, int]


Form = ArmForm | CartesianForm | WristForm | None


@dataclass(frozen=True, slots=True, eq=False)
class SingularStructure:
    """A robot's structure.

    Attributes:
        form: `Arm`, `Mill`, `Wrist`, or None if nothing is found.
        length: Characteristic length [m].
    """

    form: Form
    length: float


def singular_structure(robot: Mechanism) -> SingularStructure:
    """Return a robot's structure, found at first use."""
    return robot.prepared("singular structure", lambda: _found(robot))


def _found(robot: Mechanism) -> SingularStructure:
    probes = [lines_at(robot, values) for values in _probe_positions(robot)]
    length = characteristic_length(robot.chain)
    return SingularStructure(_form(robot.chain, probes, length), length)


def lines_at(robot: Mechanism, axes: ArrayLike) -> Lines:
    """Return the lines of all joints at axis values (n_axes,), mm and degrees."""
    return lines_at_q(robot, robot.q(axes))


def lines_at_q(robot: Mechanism, q: Vector) -> Lines:
    """Return the lines of all joints at joint values (n_q,): metres and radians, coupled or not."""
    screws = screws_at(robot, q).T
    turning = np.array([joint.kind == "revolute" for joint in robot.chain.joints])
    directions = np.where(turning[:, None], screws[:, 3:], screws[:, :3])
    return Lines(directions, np.where(turning[:, None], np.cross(screws[:, 3:], screws[:, :3]), 0.0))


def _probe_positions(robot: Mechanism) -> list[Vector]:
    """Return positions inside the limits at which no joints are aligned by chance."""
    rng = np.random.default_rng(7)
    lower, upper = np.array([usual_range(axis) for axis in robot.axes]).T
    inner = 0.1 * (upper - lower)
    axis_map = robot.chain.axis_map
    drawn = (random_axis_values(axis_map, rng, lower + inner, upper - inner)[0] for _ in range(_TRIES * _PROBES))
    # Limits may be wider than what the axis map has joint values for.
    having_a_pose = (axes for axes in drawn if np.isfinite(robot.chain.axis_map.q(axes)).all())
    return list(islice(having_a_pose, _PROBES))


def _form(chain: Chain, probes: list[Lines], length: float) -> Form:
    if not probes:
        return None  # hardly anything closes
    # A joint that stands still, or turns nothing but itself, has no line.
    moving = [n for n in joints_between_tips(chain) if all(lines.directions[n].any() for lines in probes)]
    rotary = [n for n in moving if chain.joints[n].kind == "revolute"]
    linear = [n for n in moving if chain.joints[n].kind == "prismatic"]
    free = [n for n in linear if not _held(chain, n)]
    if free and np.linalg.matrix_rank(probes[0].directions[free], tol=_SAME) == 3:
        return CartesianForm(tuple(rotary))
    rotary = _lines_once(probes, [n for n in rotary if not _held(chain, n)], length)
    for i in range(len(rotary) - 2):
        if _parallel(probes, rotary[i], rotary[i + 1]):
            return _arm(probes, rotary, i, length)
    wrist = _meeting(probes, rotary, length) if len(rotary) > 3 or linear else ()
    return WristForm(wrist) if len(wrist) == 3 else None


def _lines_once(probes: list[Lines], rotary: list[int], length: float) -> list[int]:
    """Return the joints without those that turn about the line of the next one: a level link and its carried joints."""

    def same(a: int, b: int) -> bool:
        offsets = [np.cross(p.directions[a], p.points[a] - p.points[b]) for p in probes]
        return _parallel(probes, a, b) and all(np.linalg.norm(offset) < _SAME * length for offset in offsets)

    return [a for a, b in zip(rotary, [*rotary[1:], None], strict=True) if b is None or not same(a, b)]


def _held(chain: Chain, joint: int) -> bool:
    """Return whether only input axes move a joint."""
    middle = np.array([(axis.lower + axis.upper) / 2.0 for axis in chain.axes])
    row = chain.axis_map.dq_daxes(middle)[joint]
    return all(axis.held for axis, factor in zip(chain.axes, row, strict=True) if factor)


def _arm(probes: list[Lines], rotary: list[int], i: int, length: float) -> ArmForm:
    rest = rotary[i + 2 :]
    head = _meeting(probes, rest, length)
    tip = (rest[0],) if _parallel(probes, rotary[i], rest[0]) else head
    turn = rotary[i - 1] if i and _perpendicular(probes, rotary[i - 1], rotary[i]) else None
    wrist = (rest[-3], rest[-2], rest[-1]) if len(rest) >= 3 else None
    return ArmForm(rotary[i], rotary[i + 1], tip, turn, head, wrist)


def _meeting(probes: list[Lines], joints: list[int], length: float) -> tuple[int, ...]:
    """Return the last three, else the last two joints whose lines meet in a point, else the last joint."""
    for count in (3, 2):
        last = tuple(joints[-count:])
        if len(last) == count and all(_gap(lines, last) < _SAME * length for lines in probes):
            return last
    return (joints[-1],)


def nearest_point_to_lines(lines: Lines, joints: tuple[int, ...]) -> Vector:
    """Return the point (3,) nearest to the lines of joints, and of all such points the one nearest to the tool."""
    A, b = np.zeros((3, 3)), np.zeros(3)
    for n in joints:
        d = lines.directions[n]
        across = np.eye(3) - np.outer(d, d)
        A += across
        b += across @ lines.points[n]
    return np.asarray(np.linalg.lstsq(A, b, rcond=1e-12)[0], dtype=float)


def _gap(lines: Lines, joints: tuple[int, ...]) -> float:
    """Return how far the lines of joints miss a common point [m]; inf where they are all parallel."""
    directions = lines.directions[list(joints)]
    if np.linalg.matrix_rank(directions, tol=_SAME) < 2:
        return float("inf")
    point = nearest_point_to_lines(lines, joints)
    offsets = np.cross(directions, point - lines.points[list(joints)])
    return float(np.linalg.norm(offsets, axis=1).max())


def _parallel(probes: list[Lines], a: int, b: int) -> bool:
    return all(np.linalg.norm(np.cross(p.directions[a], p.directions[b])) < _SAME for p in probes)


def _perpendicular(probes: list[Lines], a: int, b: int) -> bool:
    return all(abs(float(p.directions[a] @ p.directions[b])) < _SAME for p in probes)
