"""The chapter on reach: how far the tool gets within the limits, by search.

Random positions show about where an extreme lies; from the best of them axes are moved one by one, in steps that are
halved, as long as the value improves and all limits hold.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.analysis.singularity.structure import ArmForm, lines_at, nearest_point_to_lines, singular_structure
from chainbuild.analysis.workspace.mapspec import random_axes
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Frame
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.site import upright_frame
from chainbuild.frames import inverse, transform
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import fields_shown
from chainbuild.units import mm_from_m
from chainbuild.writers.machine_report.document.blocks import Chapter, Paragraph, TableBlock
from chainbuild.writers.machine_report.document.numbers import decimal, named_values

if TYPE_CHECKING:
    from chainbuild.arrays import Matrix, Vector

_Measure = Callable[["Matrix"], "Vector"]

_SAMPLES: Final = 4000  # positions: tens of milliseconds, and near enough to the extremes to climb from
_SLOW_SAMPLES: Final = 200  # where a nonlinear map is asked row by row
_SEED: Final = 1  # any: the same machine gives the same report
_FIRST: Final = 0.25  # of an axis' range: the first steps of a climb
_LAST: Final = 1e-5  # likewise the last ones: below a tenth of a millimetre
_CLIMBS: Final = 2  # from the best positions: one may end beside the extreme
_SAME_PLACES: Final = 7  # decimals of metres that decide between them: the last bits must not
_BETTER: Final = 1e-9  # m: what is less is rounding, in which processors differ
_MATTERS: Final = 7.0  # degrees, mm: an axis by which nothing changes over these does not matter
_UPRIGHT: Final = 1e-9  # share across z of a direction that is upright


@dataclass(frozen=True, slots=True, eq=False)
class Extreme:
    """The least or largest value of a length, and where.

    Attributes:
        value: [m].
        axes: (n_axes,) axis values, mm and degrees.
    """

    __repr__ = fields_shown

    value: float
    axes: Vector


def reach_chapter(robot: Mechanism) -> Chapter:
    """Return the chapter on reach."""
    start = _positions(robot)
    if not len(start):
        return Chapter(
            "Reach", [Paragraph.of("No position within the limits was found at which the machine has a pose.")]
        )
    rows = []
    for name, measure in _measures(robot):
        ends = (extreme_of(robot, measure, start, sign) for sign in (-1.0, 1.0))
        rows.append([name, *(cell for end in ends for cell in _end(robot, measure, end))])
    told = "Within all limits, the tool mounted as the file says, found by search and rounded to whole millimetres"
    held = [axis.name for axis in robot.axes if axis.held]
    if held:
        told += f"; {', '.join(held)} at 0 or the limit next to it"
    head = ("Length", "Least [mm]", "at", "Largest [mm]", "at")
    return Chapter(
        "Reach",
        [
            Paragraph.of(f"{told}. Self-collision is not looked at here. Axes that are not named may stand anywhere."),
            TableBlock(head, rows),
        ],
    )


def _end(robot: Mechanism, measure: _Measure, found: Extreme) -> list[str]:
    """Return an extreme in mm, and the axes that matter there."""
    count = len(found.axes)
    moved = np.repeat(found.axes[None, :], count, axis=0) + _MATTERS * np.eye(count)
    same = np.abs(measure(moved) - found.value) < _BETTER
    kept = [n for n, axis in enumerate(robot.axes) if not (same[n] or axis.held)]
    at = named_values([robot.axes[n] for n in kept], found.axes[kept], 0)
    return [decimal(mm_from_m(found.value), 0), at]


def _measures(robot: Mechanism) -> Iterator[tuple[str, _Measure]]:
    """Yield lengths by name: functions of rows of axis values (N, n_axes) that return them (N,) [m]."""
    for n, letter in enumerate("XYZ"):
        yield f"TCP along {letter} of the workpiece frame", _coordinate(robot, n)
    form = singular_structure(robot).form if not robot.chain.loops else None
    if not isinstance(form, ArmForm) or form.turn is None:
        yield "TCP from the Z axis of the workpiece frame", _radius(robot)
        return
    name = robot.chain.joints[form.turn].name
    yield f"TCP from axis {name}", _radius(_seen_from_axis(robot, form.turn, None))
    if len(form.head) > 1:
        yield f"wrist point from axis {name}", _radius(_seen_from_axis(robot, form.turn, form.head))


def _coordinate(robot: Mechanism, n: int) -> _Measure:
    return lambda rows: _tips(robot, rows)[:, n]


def _radius(robot: Mechanism) -> _Measure:
    def measure(rows: Matrix) -> Vector:
        tips = _tips(robot, rows)
        radii: Vector = np.hypot(tips[:, 0], tips[:, 1])
        return radii

    return measure


def _tips(robot: Mechanism, rows: Matrix) -> Matrix:
    """Return where the tool is (N, 3) in the workpiece frame [m], not a number where there is no pose."""
    if robot.kinematics.product is not None:
        tips: Matrix = robot.fk_batch(rows)[:, :3, 3]
        return tips
    found = np.full((len(rows), 3), np.nan)
    having = [n for n, row in enumerate(rows) if np.isfinite(robot.chain.axis_map.q(row)).all()]
    found[having] = robot.fk_batch(rows[having])[:, :3, 3] if having else 0.0
    return found


def _seen_from_axis(robot: Mechanism, turn: int, head: tuple[int, ...] | None) -> Mechanism:
    """Return an arm whose workpiece frame has its z on a joint's line, and whose tool is the wrist point if wanted."""
    chain = robot.chain
    joint = chain.joints[turn]
    direction = joint.direction
    if float(np.hypot(direction[0], direction[1])) < _UPRIGHT:
        along = np.eye(3)
    else:
        along = upright_frame(direction)[:, [1, 2, 0]]
    frames = {frame.name: frame for frame in chain.frames}
    frames["workpiece"] = Frame("workpiece", joint.parent, joint.T_parent_joint @ transform(along))
    if head is not None:
        frames["tool"] = _wrist_frame(robot, head)
    return Mechanism(replace(chain, frames=tuple(frames.values())))


def _wrist_frame(robot: Mechanism, head: tuple[int, ...]) -> Frame:
    """Return a frame where lines of joints meet, on the link between the first two of them."""
    chain = robot.chain
    axes = np.array([(axis.lower + axis.upper) / 2.0 for axis in robot.axes])
    point = nearest_point_to_lines(lines_at(robot, axes), head)
    links = link_placements(chain, robot.q(axes))
    tool = chain.frame("tool")
    place = links[tool.link] @ tool.T_link_frame @ np.append(point, 1.0)
    link = chain.joints[head[0]].child
    return Frame("tool", link, transform(None, (inverse(links[link]) @ place)[:3]))


def _positions(robot: Mechanism) -> Matrix:
    """Return random positions (N, n_axes) inside all limits that have a pose."""
    count = _SAMPLES if robot.kinematics.product is not None else _SLOW_SAMPLES
    rows = random_axes(robot, np.random.default_rng(_SEED), count)
    rows = rows[robot.limits.inside_rows(rows)]
    inside: Matrix = rows[np.isfinite(_tips(robot, rows)).all(axis=1)]
    return inside


def extreme_of(robot: Mechanism, measure: _Measure, start: Matrix, sign: float) -> Extreme:
    """Return the largest value of a length, for sign -1 the least, found from positions (N, n_axes)."""
    values = sign * measure(start)
    best = np.argsort(-values, kind="stable")[: _CLIMBS if robot.kinematics.product is not None else 1]
    found = [_climbed(robot, measure, start[n], sign) for n in best.tolist()]
    return max(found, key=lambda one: round(sign * one.value, _SAME_PLACES))


def _ways(robot: Mechanism) -> Matrix:
    """Return the directions (n, n_axes) of a climb: each axis alone, and pairs that limits tie together."""
    lower, upper = shown_limits(robot.chain)
    free = [n for n, axis in enumerate(robot.axes) if not axis.held]
    alone = np.diag(upper - lower)[free]
    coupled = sorted(robot.limits.together & set(free))
    pairs = [
        (np.eye(len(lower))[n] - sign * np.eye(len(lower))[m]) * min(upper[n] - lower[n], upper[m] - lower[m])
        for n, m in combinations(coupled, 2)
        for sign in (1.0, -1.0)
    ]
    ways: Matrix = np.concatenate([alone, *([pairs] if pairs else [])])
    return np.concatenate([ways, -ways])


def _climbed(robot: Mechanism, measure: _Measure, start: Vector, sign: float) -> Extreme:
    """Return the extreme that a climb from a position (n_axes,) ends at."""
    lower, upper = shown_limits(robot.chain)
    ways = _ways(robot)
    axes, value = start.copy(), float(sign * measure(start[None, :])[0])
    step = _FIRST
    while step > _LAST:
        moved = np.clip(axes + step * ways, lower, upper)
        found = sign * measure(moved)
        found = np.where(robot.limits.inside_rows(moved) & np.isfinite(found), found, -np.inf)
        k = int(np.argmax(found))
        if found[k] > value + _BETTER:
            axes, value = moved[k], float(found[k])
        else:
            step /= 2.0
    return Extreme(sign * value, axes)
