"""The chapter on singular positions: by name, where they lie in axis values, what is lost there and why."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.analysis.singularity.measures import smallest_value
from chainbuild.analysis.singularity.names import examine
from chainbuild.analysis.singularity.nearest import nearest_singularity
from chainbuild.analysis.singularity.words import rtcp_remark
from chainbuild.analysis.vanishing.functions import SingularFunction, singular_functions
from chainbuild.analysis.workspace.mapspec import random_axes
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.closest import and_joined
from chainbuild.drawing.site import home_of
from chainbuild.errors import ChainbuildError
from chainbuild.frames import ANGLE_MODES
from chainbuild.units import deg_from_rad, si_factor
from chainbuild.writers.machine_report.document.blocks import (
    Bullets,
    Chapter,
    Heading,
    Paragraph,
    ReportBlock,
    Verbatim,
)
from chainbuild.writers.machine_report.document.numbers import decimal, named_values
from chainbuild.writers.machine_report.serial import DrivenJoint

if TYPE_CHECKING:
    from chainbuild.analysis.singularity.singularity import Singularity
    from chainbuild.analysis.singularity.structure import SingularityKind
    from chainbuild.arrays import Vector
    from chainbuild.kinematics.mechanism import Mechanism

_SEED: Final = 2  # any: the same machine gives the same report
_STARTS: Final = 12  # positions from which a singularity is sought where no function tells all of them
_GRID: Final = 7  # values of each other joint tried for a position on a surface
_PLACES: Final = 2  # decimals of axis values
_MATTERS: Final = 7.0  # degrees, mm: a position that stays singular over these does not depend on the axis
_SINGULAR: Final = 1e-5  # scaled singular value, which a descent brings to 1e-7
_ONE_VALUE: Final = re.compile(r" \([^()]* = [^()]*\)")  # "(A5 = 0°)", in which sentences on whole turns differ
_COUPLING: Final = "KIN_TYP 210"
_SLIGHT: Final = 1e-9  # of an amplitude: what is less is rounding
_TITLES: Final = {
    "wrist": "Wrist", "elbow": "Elbow", "shoulder": "Shoulder", "pole": "Pole", "tilt_end": "End of the tilt",
    "strut": "Strut", "platform": "Platform", "twist": "Twist", "other": "Axes against one another",
}  # fmt: skip


def singular_chapter(robot: Mechanism, reference: Vector) -> Chapter:
    """Return the chapter on singular positions.

    Args:
        robot: The robot.
        reference: (n_axes,) axis values of a position that is not singular; the axes that do not matter stand there.
    """
    found = singular_functions(robot)
    blocks: list[ReportBlock] = []
    for function in found.functions:
        blocks += _function_blocks(robot, function, reference)
    if not found.complete:
        seen = {function.kind for function in found.functions}
        blocks += _sought(robot, seen)
        if not blocks:
            told = f"Sought by descent from {_STARTS} random positions: none was found inside the limits."
            blocks.append(Paragraph.of(told))
    elif blocks:
        blocks.append(
            Paragraph.of("The robot is singular at these positions and nowhere else: proven by the determinant.")
        )
    if not blocks:
        blocks.append(Paragraph.of("No singular position within the limits was found."))
    if robot.chain.kinematic.startswith(_COUPLING):
        blocks.append(
            Paragraph.of(
                "All axes together: what some of them lose, the others make up for. A partial kinematic that is moved "
                "alone has its own singular positions, and they stand in its own report: ",
                Verbatim("chainbuild export FILE --format report --kinematic NAME"),
                ".",
            )
        )
    if remark := rtcp_remark(robot):
        blocks.append(Paragraph.of(f"They matter {remark}."))
    blocks += _gimbal_lock(robot)
    return Chapter("Singular positions", blocks)


def _function_blocks(robot: Mechanism, function: SingularFunction, reference: Vector) -> Iterator[ReportBlock]:
    joints = [int(n) for n in np.flatnonzero(np.abs(function.multiples).max(axis=0))]
    if len(joints) == 1:
        values = _roots_inside(robot, function, joints[0], reference)
        where = _values_in_words(robot, joints[0], values)
        # Whole turns lose the same: the nearest to zero stands for all.
        alike = {round(math.remainder(value, math.tau) % math.tau, 6): value for value in sorted(values, key=abs)[::-1]}
        places = [_plain_place(robot, function.kind, joints[0], value, reference) for value in alike.values()]
    else:
        names = and_joined([robot.chain.joints[n].name for n in joints])
        place = _on_surface(robot, function, joints, reference)
        where = f"a surface in the values of {names}"
        if place is not None:
            where += f", for instance {_place_in_words(robot, place, joints)}"
        places = [] if place is None else [place]
    if not places:
        yield Heading((_TITLES[function.kind],))
        yield Paragraph.of(
            "Outside the limits." if len(joints) == 1 else "No such position within the limits was found."
        )
        return
    yield from _named(robot, function.kind, where, places)


def _named(robot: Mechanism, kind: str, where: str, places: Sequence[Vector]) -> Iterator[ReportBlock]:
    """Yield what there is to say on a kind of singularity, in the words for positions on it."""
    wanted = ("pole", "tilt_end") if kind == "pole" else (kind,)
    told = [(axes, found) for axes in places for found in examine(robot, axes).names if found.kind in wanted]
    kinds = list(dict.fromkeys(_title(found) for _, found in told)) or [_TITLES[kind]]
    yield Heading((and_joined(kinds),))
    yield Paragraph.of(f"Where: {where}.")
    if not told:
        yield Paragraph.of("Not singular all the same: the other axes make up for what these lose.")
    texts: dict[str, str] = {}
    for axes, found in told:
        texts.setdefault(_ONE_VALUE.sub("", found.sentence), _told_at(robot, axes, found))
        if remark := _own_remark(robot, found):
            texts.setdefault(remark, _sentence(robot, remark))
    if texts:
        yield Bullets(tuple(Paragraph.of(text) for text in texts.values()))


def _told_at(robot: Mechanism, axes: Vector, found: Singularity) -> str:
    """Return what is lost, and where: a direction in the flange frame holds at one position."""
    return f"{_sentence(robot, found.sentence)} (Seen at {named_values(robot.axes, axes.tolist(), _PLACES)}.)"


def _sentence(robot: Mechanism, text: str) -> str:
    """Return a text as a sentence; a name stays as it is written."""
    named = text.split(maxsplit=1)[0] in {joint.name for joint in robot.chain.joints}
    return f"{text if named else text[0].upper() + text[1:]}."


def _own_remark(robot: Mechanism, found: Singularity) -> str:
    return "" if found.remark == rtcp_remark(robot) else found.remark


def _title(found: Singularity) -> str:
    return f"{_TITLES[found.kind]} ({found.alias})" if found.alias else _TITLES[found.kind]


def _roots_inside(robot: Mechanism, function: SingularFunction, joint: int, reference: Vector) -> list[float]:
    """Return the values [rad] of the only joint of a function at which it is 0, inside the limits."""
    axis_map = _affine(robot)
    row, factors = axis_map.A[joint], robot.kinematics.si_factors
    sides = np.stack([row * end * factors for end in shown_limits(robot.chain)])
    ends = axis_map.b[joint] + np.sort(sides, axis=0).sum(axis=1)
    found = []
    for root in _roots(function, joint, robot.q(reference)):
        turns = range(math.floor((ends[0] - root) / math.tau), math.ceil((ends[1] - root) / math.tau) + 1)
        found += [root + k * math.tau for k in turns]
    found = sorted({round(value, 9): value for value in found}.values())
    return [value for value in found if robot.limits.inside_rows(_at(robot, reference, joint, value)[None, :])[0]]


def _roots(function: SingularFunction, joint: int, q: Vector) -> list[float]:
    """Return the values [rad] of one joint at which a function is 0, the others at joint values (n_q,)."""
    others = q.copy()
    others[joint] = 0.0
    phases = function.multiples @ others + function.phases
    multiples = function.multiples[:, joint]
    constant = float(function.amplitudes[multiples == 0.0] @ np.cos(phases[multiples == 0.0]))
    turning = multiples != 0.0
    wave = complex((function.amplitudes[turning] * np.exp(1j * multiples[turning] * phases[turning])).sum())
    size, phase = abs(wave), math.atan2(wave.imag, wave.real)
    if size < _SLIGHT or abs(constant) > size:
        return []
    opening = math.acos(-constant / size)
    return list(dict.fromkeys((-phase + opening, -phase - opening)))


def _affine(robot: Mechanism) -> AffineMap:
    axis_map = robot.chain.axis_map
    assert isinstance(axis_map, AffineMap)  # functions exist of nothing else
    return axis_map


def _driver(robot: Mechanism, joint: int) -> int:
    """Return the index of the axis that moves a joint: that of its name, else the one that moves it most."""
    sizes = np.abs(_affine(robot).A[joint])
    named = [
        n for n, axis in enumerate(robot.axes) if axis.name == robot.chain.joints[joint].name and sizes[n] > _SLIGHT
    ]
    return named[0] if named else int(np.argmax(sizes))


def _at(robot: Mechanism, axes: Vector, joint: int, value: float) -> Vector:
    """Return axis values at which a joint has a value [rad], moved by its own axis."""
    n = _driver(robot, joint)
    moved = axes.copy()
    missing = value - float(robot.q(axes)[joint])
    moved[n] += missing / (float(_affine(robot).A[joint, n]) * si_factor(robot.axes[n].kind))
    return moved


def _plain_place(robot: Mechanism, kind: str, joint: int, value: float, reference: Vector) -> Vector:
    """Return axis values with a joint at a value: home where it is singular in that one way only, else the reference.

    At home axes are parallel to frames, and what is lost has a name.
    """
    home = home_of(robot.chain)
    if home is not None:
        place = _at(robot, home, joint, value)
        kinds = {found.kind for found in examine(robot, place).names}
        if robot.limits.inside_rows(place[None, :])[0] and kinds == {kind}:
            return place
    return _at(robot, reference, joint, value)


def _values_in_words(robot: Mechanism, joint: int, values: Sequence[float]) -> str:
    """Return where a joint stands as a condition on axis values: "A5 = 0°"."""
    axis_map = _affine(robot)
    terms = tuple(
        (float(f), axis.name) for f, axis in zip(axis_map.A[joint], robot.axes, strict=True) if abs(f) > _SLIGHT
    )
    found = {decimal(deg_from_rad(value - float(axis_map.b[joint])), _PLACES) for value in values}
    sums = DrivenJoint("", True, terms).text()
    return f"{sums} = {' or '.join(f'{value}°' for value in sorted(found, key=float))}"


def _on_surface(
    robot: Mechanism, function: SingularFunction, joints: Sequence[int], reference: Vector
) -> Vector | None:
    """Return axis values at which a function of several joints is 0: of a grid the first singular in no other way."""
    first = None
    lower, upper = shown_limits(robot.chain)
    last, others = joints[-1], joints[:-1]
    axes_of = [_driver(robot, joint) for joint in others]
    shares = sorted(np.linspace(0.05, 0.95, _GRID).tolist(), key=lambda share: abs(share - 0.5))
    for picked in np.stack(np.meshgrid(*[shares] * len(others), indexing="ij"), axis=-1).reshape(-1, len(others)):
        axes = reference.copy()
        axes[axes_of] = np.round(lower[axes_of] + picked * (upper[axes_of] - lower[axes_of]))
        for root in _roots(function, last, robot.q(axes)):
            for turn in (0.0, -math.tau, math.tau):
                place = _at(robot, axes, last, root + turn)
                if not robot.limits.inside_rows(place[None, :])[0]:
                    continue
                first = place if first is None else first
                if {found.kind for found in examine(robot, place).names} == {function.kind}:
                    return place
    return first


def _place_in_words(robot: Mechanism, axes: Vector, joints: Sequence[int] = ()) -> str:
    """Return the axis values of a singular position: of the drivers of some joints, and of those that matter."""
    kept = sorted(
        {_driver(robot, joint) for joint in joints}
        | {n for n in range(len(axes)) if not smallest_value(robot, axes + _MATTERS * np.eye(len(axes))[n]) < _SINGULAR}
    )
    return named_values([robot.axes[n] for n in kept], axes[kept], _PLACES) or "everywhere"


def _sought(robot: Mechanism, seen: set[SingularityKind]) -> Iterator[ReportBlock]:
    """Yield the singularities that descents from random positions end at, one of each kind and axes."""
    told: dict[tuple[str, tuple[str, ...]], None] = {}
    for start in random_axes(robot, np.random.default_rng(_SEED), _STARTS):
        try:
            nearest = nearest_singularity(robot, start, inside=True)
            if not (nearest.found and nearest.inside):
                continue
            names = examine(robot, nearest.axes).names
        except ChainbuildError:
            continue
        for found in names[:1]:
            key = (found.kind, tuple(sorted(found.axes)))
            if found.kind in seen or key in told:
                continue
            if not told:
                yield Paragraph.of("Found by descent from random positions; there may be others.")
            told[key] = None
            yield Heading((_title(found),))
            yield Paragraph.of(f"Where: for instance {_place_in_words(robot, nearest.axes)}.")
            remark = _own_remark(robot, found)
            texts = [_told_at(robot, nearest.axes, found), *([_sentence(robot, remark)] if remark else [])]
            yield Bullets(tuple(Paragraph.of(text) for text in texts))


def _gimbal_lock(robot: Mechanism) -> Iterator[ReportBlock]:
    """Yield where the displayed angles are not unique, which loses no motion."""
    chain = robot.chain
    mode = ANGLE_MODES[chain.angle_mode]
    if chain.display.kind != "angles" or len(chain.display.columns) < len(mode.factors) or chain.follows_c:
        return
    (first, a, _), (_, b, _), (last, c, _) = mode.factors
    where = f"{b} = 0° and 180°" if first == last else f"{b} = 90° and {b} = -90°"
    yield Heading(("Pose angles",))
    yield Paragraph.of(
        f"At {where} the angles {a} and {c} turn about the same line ({mode.meaning}): no motion is lost, but "
        f"the control may show another pair {a}, {c} for the same orientation."
    )
