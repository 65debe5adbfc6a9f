"""Any serial machine as KIN_TYP 91: the same poses from a list of axes, to be corrected where axes are out of true.

    T_91 = Π M(axis), from the workpiece over the machine origin to the tool
    pose of the type = S⁻¹ · T_91

S is the type's workpiece frame at zero, seen from the machine: KIN_TYP 91 refers to the machine's
coordinate system there. It is written into the list as a comment; on the controller it is a zero offset.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Chain, Joint
from chainbuild.chain.poses import frame_placement, link_placements, path_to
from chainbuild.errors import UnsupportedKinematicError
from chainbuild.formats.machine import Machine
from chainbuild.formats.text import URDF
from chainbuild.frames import urdf_rpy
from chainbuild.units import AxisKind, deg_from_rad, m_from_mm, mm_from_m, raw_from_mm

_MAX_ROTARY: Final = 3  # what KIN_TYP 91 permits
_LINEAR: Final = 3  # X, Y and Z come first in KIN_TYP 91
_NOISE: Final = 1e-15  # factors and matrix entries: the last bit
_SAME_PLACE: Final = 1e-12  # m
_TRIAL_LENGTH_MM: Final = 100.0  # any: the tool's end moves with it or does not
_COUNT_DIGITS: Final = 7  # of 1e-4 mm


@dataclass(frozen=True, slots=True, eq=False)
class UniversalAxisOf:
    """One axis of the list: its name, kind, direction as entered, and a point on it [m]."""

    name: str
    kind: AxisKind
    orientation: Vector
    point: Vector


@dataclass(frozen=True, slots=True, eq=False)
class Universal:
    """A chain written as KIN_TYP 91.

    Attributes:
        axes: Axes in channel order.
        order: Their indices in the order met from the workpiece to the tool.
        workpiece: How many of these come before the machine origin.
        T_zero: (4, 4) the tool frame at zero in the machine's coordinate system [m].
        shift: (4, 4) S: the type's workpiece frame at zero in the machine's coordinate system [m].
    """

    axes: tuple[UniversalAxisOf, ...]
    order: tuple[int, ...]
    workpiece: int
    T_zero: Matrix
    shift: Matrix


def as_universal(
    machine: Machine,
    kinematic: int | str | tuple[int | str, int | str] | None = None,
    channel: int | None = None,
    *,
    conventions: Mapping[str, str] | None = None,
) -> str:
    """Return a parameter list of KIN_TYP 91 that gives the same poses as a kinematic of a machine.

    Args:
        machine: The machine.
        kinematic: Id or name; None: the default. See `Machine.chain`.
        channel: Channel; None: the first that has a kinematic.
        conventions: Convention name → choice.

    Raises:
        UnsupportedKinematicError: a universal kinematic cannot express the machine, with the reason.
    """
    chain = machine.chain(kinematic, channel, 0.0, conventions)
    universal = universal_of(chain)
    if machine.dialect == URDF:  # which takes no tool length
        return list_text(chain, universal, False)
    longer = machine.chain(kinematic, channel, _TRIAL_LENGTH_MM, conventions)
    return list_text(chain, universal, _lengthens_alike(chain, longer, universal))


def _lengthens_alike(chain: Chain, longer: Chain, universal: Universal) -> bool:
    """Return whether a tool length acts along minus the tool vector, as it does in KIN_TYP 91."""
    if not isinstance(longer.axis_map, AffineMap):
        return False
    zero = np.zeros(len(chain.axes))
    end = frame_placement(longer, "tool", zero)[:3, 3] - frame_placement(chain, "tool", zero)[:3, 3]
    return bool(np.abs(end + m_from_mm(_TRIAL_LENGTH_MM) * universal.T_zero[:3, 2]).max() < _SAME_PLACE)


def universal_of(chain: Chain) -> Universal:
    """Return a chain as KIN_TYP 91.

    Raises:
        UnsupportedKinematicError: see `as_universal`.
    """
    factors = _factors(chain)
    axis_map = chain.axis_map
    links = link_placements(chain, axis_map.q(np.zeros(len(chain.axes))))
    tool, workpiece = chain.frame("tool"), chain.frame("workpiece")
    on_tool = {joint.name for joint in path_to(chain, tool.link)}
    on_workpiece = {joint.name for joint in path_to(chain, workpiece.link)}
    ahead = [joint for joint in reversed(path_to(chain, workpiece.link)) if joint.name not in on_tool]
    behind = [joint for joint in path_to(chain, tool.link) if joint.name not in on_workpiece]
    found: dict[int, UniversalAxisOf] = {}
    for joint, side in (*((joint, -1.0) for joint in ahead), *((joint, 1.0) for joint in behind)):
        if joint.name in factors:
            n, factor = factors[joint.name]
            T = links[joint.parent] @ joint.T_parent_joint
            orientation = side * factor * (T[:3, :3] @ joint.direction)
            found[n] = UniversalAxisOf(chain.axes[n].name, chain.axes[n].kind, orientation, T[:3, 3])
    _check(chain, found)
    return Universal(
        axes=tuple(found[n] for n in range(len(chain.axes))),
        order=tuple(found),
        workpiece=sum(joint.name in factors for joint in ahead),
        T_zero=links[tool.link] @ tool.T_link_frame,
        shift=links[workpiece.link] @ workpiece.T_link_frame,
    )


def _factors(chain: Chain) -> dict[str, tuple[int, float]]:
    """Return for every joint that moves the axis that drives it, and its factor."""
    if not isinstance(chain.axis_map, AffineMap):
        raise _refusal(chain, "its programmed values drive the machine axes nonlinearly")
    if chain.loops:
        raise _refusal(chain, "it is a parallel kinematic")
    found: dict[str, tuple[int, float]] = {}
    for joint, row in zip(chain.joints, chain.axis_map.A, strict=True):
        driving = np.flatnonzero(row)
        if len(driving) > 1:
            names = " and ".join(chain.axes[n].name for n in driving)
            raise _refusal(chain, f"{names} together drive joint {joint.name}")
        if len(driving) == 1:
            factor = float(row[driving[0]])
            if chain.axes[int(driving[0])].kind != _kind(joint) or abs(abs(factor) - 1.0) > _NOISE:
                raise _refusal(chain, f"joint {joint.name} moves by {factor:g} times its axis")
            found[joint.name] = (int(driving[0]), factor)
    return found


def _check(chain: Chain, found: Mapping[int, UniversalAxisOf]) -> None:
    if len(found) != len(chain.axes) or len({*found}) != len(chain.axes):
        raise _refusal(chain, "an axis moves neither tool nor workpiece, or both, or several joints")
    kinds = [axis.kind for axis in chain.axes]
    if kinds[:_LINEAR] != ["linear"] * _LINEAR or kinds.count("linear") != _LINEAR:
        raise _refusal(chain, f"its axes are {' '.join(kinds)}; three linear ones must come first")
    if kinds.count("rotary") > _MAX_ROTARY:
        raise _refusal(chain, f"it has {kinds.count('rotary')} rotary axes, at most {_MAX_ROTARY} are permitted")


def _refusal(chain: Chain, reason: str) -> UnsupportedKinematicError:
    return UnsupportedKinematicError(f"{chain.kinematic} cannot be written as KIN_TYP 91: {reason}")


def _kind(joint: Joint) -> AxisKind:
    return "linear" if joint.kind == "prismatic" else "rotary"


def list_text(chain: Chain, universal: Universal, lengthens: bool = True) -> str:
    """Return the parameter list of a universal kinematic.

    Args:
        chain: What it was made from.
        universal: Its axes.
        lengthens: False where a tool length acts differently there; the list then says so.
    """
    lines = [
        f"# {chain.title}: {chain.kinematic} written as KIN_TYP 91, the universal kinematic.",
        *(f"# Convention {used.convention.name} = {used.choice}" for used in chain.conventions),
        *_shift_lines(universal),
        *(() if lengthens else ("# For tools of length 0 only: a tool length acts differently in the type.",)),
        "trafo[0].id 91",
        *_vector("zero_orientation", universal.T_zero[:3, 2]),
        *_vector("zero_position", _counts(universal.T_zero[:3, 3])),
        f"trafo[0].number_of_axes {len(universal.axes)}",
        *(f"trafo[0].chain[{k}] {n}" for k, n in enumerate(universal.order)),
    ]
    for n, axis in enumerate(universal.axes):
        side = "workpiece, entered multiplied by -1" if n in universal.order[: universal.workpiece] else "tool"
        lines += [f"# Axis {axis.name} on the side of the {side}", f"trafo[0].axis[{n}].type {_TYPES[axis.kind]}"]
        lines += _vector(f"axis[{n}].orientation", axis.orientation)
        if axis.kind == "rotary":
            lines += _vector(f"axis[{n}].point", _counts(axis.point))
    if any(axis.generic for axis in chain.axes):  # the channel has names of its own for them
        lines += [f"gruppe[0].achse[{n}].bezeichnung {axis.name}" for n, axis in enumerate(universal.axes)]
    lines += ["trafo[0].programming_mode 12", "trafo[0].rtcp 1", "Ende"]
    return "\n".join(lines) + "\n"


_TYPES: Final = {"linear": 1, "rotary": 2}


def _shift_lines(universal: Universal) -> list[str]:
    """Return what the reader must know of the two coordinate systems."""
    x, y, z = (_plain(mm_from_m(float(value)), 9) for value in universal.shift[:3, 3])
    lines = []
    if np.abs(universal.shift - np.eye(4)).max() < _NOISE:
        lines.append("# Both refer to the same coordinate system.")
    else:
        lines.append(f"# Constant shift: the type's workpiece zero lies at X {x} Y {y} Z {z} (mm) of this kinematic.")
    if np.abs(universal.shift[:3, :3] - np.eye(3)).max() >= _NOISE:
        angles = urdf_rpy(universal.shift[:3, :3])
        a, b, c = (_plain(deg_from_rad(angle), 9) for angle in angles)
        lines.append(f"# Its axes are turned: Rz({c}) Ry({b}) Rx({a}), degrees.")
    return lines


def _vector(name: str, values: Vector) -> list[str]:
    return [f"trafo[0].{name}[{i}] {_plain(float(value))}" for i, value in enumerate(values)]


def _counts(position: Vector) -> Vector:
    return np.array([round(raw_from_mm(mm_from_m(float(value))), _COUNT_DIGITS) for value in position])


def _plain(value: float, digits: int | None = None) -> str:
    """Return the shortest text that reads back as the number; noise of the last bit is 0."""
    value = value if digits is None else round(value, digits)
    if abs(value) < _NOISE:
        value = 0.0
    return str(int(value)) if value == int(value) else repr(value)
