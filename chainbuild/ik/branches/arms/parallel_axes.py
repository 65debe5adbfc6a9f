"""The measures of an arm of six rotary axes of which 2, 3 and 4, or 3, 4 and 5, are parallel.

The second kind is the first one seen from the tool.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.frames import inverse, transform
from chainbuild.ik.branches.arms.orientation import perpendicular
from chainbuild.ik.branches.arms.positioner import MEETING, meeting_point, parallel
from chainbuild.ik.branches.core.plain import PlainVector
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.core.subproblems import cross, norm, perpendicular_part

_TRIALS: Final = 2  # sets of joint values at which the joints must move the tool in all six freedoms
_SINGULAR: Final = 1e-9  # share of the largest singular value below which they do not


class ParallelArm(NamedTuple):
    """An arm with three parallel axes, in the frame whose z axis is axis 2.

    Attributes:
        before: (4, 4) the workpiece frame seen from that frame [m].
        after: (4, 4) that frame seen from the tool, where all joints are 0.
        axes: Directions of axes 1, 5 and 6.
        points: On axis 1, on axis 5, on axis 6 [m]; the last one on both where 5 and 6 meet.
        tip: On axis 4 [m].
        links: Distances of axes 2 and 3, 3 and 4 [m].
        lead: Angle of the first link.
        bend: Angle from the first link to the second one.
        signs: Of axes 3 and 4: -1 where they count against axis 2.
        alone: Which equation has angle 1 alone: 0 that of the point, 1 that of the direction, 2 none.
        size: Of the arm [m].
        backwards: True where it is the arm seen from the tool.
    """

    before: Matrix
    after: Matrix
    axes: tuple[PlainVector, PlainVector, PlainVector]
    points: tuple[PlainVector, PlainVector, PlainVector]
    tip: PlainVector
    links: tuple[float, float]
    lead: float
    bend: float
    signs: tuple[float, float]
    alone: int
    size: float
    backwards: bool


def parallel_arm(serial: Serial) -> ParallelArm | None:
    """Return the measures of an arm with three parallel axes, or None if it is none."""
    screws = serial.screws
    if len(screws) != 6 or any(screw.kind != "revolute" for screw in screws):
        return None
    if _has_middle_parallel(screws):
        return _measured(serial, backwards=False)
    return _measured(serial.reversed(), backwards=True) if _has_middle_parallel(screws[::-1]) else None


def three_parallel_constants(serial: Serial) -> Vector | None:
    """Return the measures of an arm with three parallel axes as numbers for compiled code, or None if it is none."""
    arm = parallel_arm(serial)
    if arm is None:
        return None
    single = (*arm.links, arm.lead, arm.bend, *arm.signs, float(arm.alone), arm.size, float(arm.backwards))
    parts = (arm.before[:3].ravel(), arm.after[:3].ravel(), *arm.axes, *arm.points, arm.tip, single)
    return np.concatenate([np.asarray(part, dtype=float) for part in parts])


def _has_middle_parallel(screws: Sequence[Screw]) -> bool:
    """Tell whether axes 2, 3 and 4 alone are parallel, none of them and neither axis 5 and 6 the same line."""
    first, a, b, c, fifth, last = screws
    if not (parallel(a.direction, b.direction) and parallel(b.direction, c.direction)):
        return False
    if parallel(first.direction, a.direction) or parallel(fifth.direction, a.direction):
        return False
    return not any(_is_one_line(*pair) for pair in ((a, b), (b, c), (fifth, last)))


def _is_one_line(a: Screw, b: Screw) -> bool:
    between = perpendicular_part(a.direction, b.point - a.point)
    return parallel(a.direction, b.direction) and norm(between) < MEETING


def _measured(serial: Serial, *, backwards: bool) -> ParallelArm | None:
    if not _moves_in_all_freedoms(serial):
        return None
    h, origin = serial.screws[1].direction, serial.screws[1].point
    x = perpendicular(h)
    R = np.array([x, cross(h, x), h])
    before = transform(R, -R @ origin)
    first, _, elbow, wrist, fifth, last = (screw.transformed(before) for screw in serial.screws)
    meeting = meeting_point(last, fifth)
    alone = 0 if meeting is not None else 1 if parallel(fifth.direction, last.direction) else 2
    # Of each axis the point that is nearest to what comes before it: far away it would cost digits.
    on_first, on_fifth = _foot(first, np.zeros(3)), _foot(fifth, wrist.point)
    on_last = _foot(last, on_fifth) if meeting is None else meeting
    inner, outer = elbow.point, wrist.point - elbow.point
    lead = math.atan2(inner[1], inner[0])
    return ParallelArm(
        before, inverse(before @ serial.M),
        (_numbers(first.direction), _numbers(fifth.direction), _numbers(last.direction)),
        (_numbers(on_first), _numbers(on_fifth), _numbers(on_last)), _numbers(wrist.point),
        (math.hypot(inner[0], inner[1]), math.hypot(outer[0], outer[1])),
        lead, math.atan2(outer[1], outer[0]) - lead,
        (math.copysign(1.0, elbow.direction[2]), math.copysign(1.0, wrist.direction[2])),
        alone, max(norm(point) for point in (elbow.point, wrist.point, on_first, on_fifth, on_last)), backwards,
    )  # fmt: skip


def _foot(screw: Screw, point: Vector) -> Vector:
    """Return the point of an axis that is nearest to another."""
    foot: Vector = point + perpendicular_part(screw.direction, screw.point - point)
    return foot


def _moves_in_all_freedoms(serial: Serial) -> bool:
    rng = np.random.default_rng(20240229)
    for values in rng.uniform(-2.0, 2.0, (_TRIALS, 6)):
        T, columns = np.eye(4), []
        for screw, value in zip(serial.screws, values, strict=True):
            moved = screw.transformed(T)
            columns.append(np.concatenate([cross(moved.point, moved.direction), moved.direction]))
            T = T @ screw.T(float(value))
        sizes = np.linalg.svd(np.array(columns), compute_uv=False)
        if sizes[-1] < _SINGULAR * sizes[0]:
            return False
    return True


def _numbers(vector: Vector) -> PlainVector:
    x, y, z = vector.tolist()
    return x, y, z
