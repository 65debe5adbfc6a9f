"""Header of a written file: its source, assumptions, and what it cannot express."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.linkage import assumed_lengths
from chainbuild.chain.elements import Axis, Chain, Joint
from chainbuild.chain.followers import followers
from chainbuild.files import number_text
from chainbuild.formats.listing import array_name, arrays_of
from chainbuild.units import deg_from_rad, mm_from_m
from chainbuild.writers.models.masses import DENSITY

if TYPE_CHECKING:
    from chainbuild.comparison.convention_trials import Selection
    from chainbuild.formats.entries import ParameterRow
    from chainbuild.formats.machine import Machine

_SLIGHT: Final = 1e-12  # factors below this are rounding of folded directions


def urdf_limitations(chain: Chain) -> tuple[str, ...]:
    """Return what a URDF of revolute and prismatic joints cannot express of the chain, one sentence each."""
    notes = [
        f"loop {loop.name} ({loop.kind} between {loop.frame_a} and {loop.frame_b}) is open: URDF supports trees only"
        for loop in chain.loops
    ]
    if not isinstance(chain.axis_map, AffineMap):
        notes.append("the joint values depend on the axis values by a nonlinear map that URDF cannot express")
    else:
        notes += _coupling(chain, chain.axis_map)
    for axis in chain.axes:
        if axis.endless:
            notes.append(f"axis {axis.name} is endless; its joint is written with the limits of the chain")
    if lengths := assumed_lengths(chain):
        notes.append(lengths)
    assumed = [axis.name for axis in chain.axes if axis.assumed]
    if assumed:
        names = f"ax{'es' if len(assumed) > 1 else 'is'} {', '.join(assumed)}"
        notes.append(f"the limits of {names} are assumed: neither machine data nor overlay give any")
    return tuple(notes)


def _coupling(chain: Chain, axis_map: AffineMap) -> list[str]:
    notes = []
    driven = np.abs(axis_map.A) > _SLIGHT
    # A mimic joint is not a limitation.
    masters = followers(chain)
    driven[[joint.name in masters for joint in chain.joints]] = False
    for row, joint in enumerate(chain.joints):
        names = [axis.name for axis, on in zip(chain.axes, driven[row], strict=True) if on]
        if len(names) > 1:
            notes.append(f"joint {joint.name} is driven by axes {', '.join(names)}; its limits are those of their box")
        if not names and joint.name not in masters:
            notes.append(f"joint {joint.name} has a fixed value; in the file it can only be held there")
    for column, axis in enumerate(chain.axes):
        names = [joint.name for joint, on in zip(chain.joints, driven[:, column], strict=True) if on]
        if len(names) > 1:
            notes.append(f"axis {axis.name} drives joints {', '.join(names)} together; the file does not couple them")
    return notes


def axis_map_in_words(chain: Chain) -> tuple[str, ...]:
    """Return one equation for each joint whose value is not the value of the axis of its name.

    It states how the joint value q (SI) follows from the controller's axis values (mm, degrees), such as
    ``q[A3] = (A3 - A2 + 90)*pi/180``.
    """
    if not isinstance(chain.axis_map, AffineMap):
        return ("q depends on the axis values by a nonlinear map: use robot.q(axes) of chainbuild",)
    rows = zip(chain.joints, chain.axis_map.A, chain.axis_map.b, strict=True)
    return tuple(
        f"q[{joint.name}] = {_equation(joint, factors, b, chain.axes)}"
        for joint, factors, b in rows
        if not _is_its_axis(joint, factors, b, chain.axes)
    )


def _is_its_axis(joint: Joint, factors: np.ndarray, b: float, axes: tuple[Axis, ...]) -> bool:
    """Return whether a joint's value is the value of the axis of its name, both in SI."""
    own = np.array([axis.name == joint.name for axis in axes], dtype=float)
    return bool(own.any()) and b == 0.0 and bool((factors == own).all())


def _equation(joint: Joint, factors: np.ndarray, b: float, axes: tuple[Axis, ...]) -> str:
    rotary = joint.kind == "revolute"
    driving = [(axis, float(f)) for axis, f in zip(axes, factors, strict=True) if abs(f) > _SLIGHT]
    unit = "*pi/180" if rotary else "/1000"
    if any((axis.kind == "rotary") != rotary for axis, _ in driving):
        # A gear between rotation and translation: only SI avoids a second factor.
        return _sum([(_in_si(axis), f) for axis, f in driving], float(b))
    offset = deg_from_rad(float(b)) if rotary else mm_from_m(float(b))
    text = _sum([(axis.name, f) for axis, f in driving], offset)
    return f"({text}){unit}" if " " in text else f"{text}{unit}"


def _in_si(axis: Axis) -> str:
    return f"{axis.name}/1000" if axis.kind == "linear" else f"{axis.name}*pi/180"


def _sum(terms: list[tuple[str, float]], offset: float) -> str:
    parts = []
    for name, factor in terms:
        size = number_text(abs(factor))
        parts.append(("-" if factor < 0 else "+", name if size == "1" else f"{size}*{name}"))
    shown = number_text(round(abs(offset), 9))
    if shown != "0" or not parts:
        parts.append(("-" if offset < 0 else "+", shown))
    first_sign, first = parts[0]
    head = f"-{first}" if first_sign == "-" else first
    return " ".join([head, *(f"{sign} {text}" for sign, text in parts[1:])])


def header(chain: Chain, *, inertia: bool = True, data: Sequence[str] = (), loops: str = "") -> str:
    """Return the header comment of a URDF as plain text lines.

    It names no folder and no date, so that the same chain gives the same file anywhere.

    Args:
        chain: The chain.
        inertia: Whether the file holds masses.
        data: Machine data, a line each.
        loops: Name of the file beside it that says how to drive loops and couplings, if there is one.
    """
    lines = [
        f"{chain.title}: {chain.kinematic} ({chain.dialect}), written by chainbuild.",
        "",
        "Metres and radians. The links tool and workpiece are the tips: a programmed pose is tool seen from workpiece.",
        *_joint_values(chain),
        "Readers order joints differently: map them by name.",
        *_origins(chain, inertia),
    ]
    if data:
        lines += ["", "Machine data used:", *(f"  {line}" for line in data)]
    shaping = [used for used in chain.conventions if used.convention.poses]
    if shaping:
        lines += ["", "Conventions used where the manuals leave a choice ([I] inferred, [?] open):"]
        for used in shaping:
            meaning = used.convention.choices.get(used.choice, "")
            chosen = "chosen" if used.by_user else "default"
            lines.append(f"  {used.convention.name}={used.choice} [{used.convention.mark}] ({chosen}): {meaning}")
    limitations = urdf_limitations(chain)
    if limitations:
        lines += ["", "Not expressed by this file:", *(f"  {line}" for line in limitations)]
    if loops:
        lines += ["", f"{loops} says how loops and couplings are driven by axis values."]
    return "\n".join(_safe(line) for line in lines)


def _origins(chain: Chain, inertia: bool) -> list[str]:
    """Return where bodies, masses, efforts and speeds come from."""
    geometry = chain.geometry
    given = bool(geometry.shapes or geometry.visuals)
    lines = ["Bodies are those given, else primitives by rule." if given else "Bodies are primitives by rule."]
    if geometry.inertias:
        lines.append("Masses are those given." if inertia else "Masses are left out.")
    elif inertia:
        lines.append(f"Masses are ESTIMATES: the bodies solid, of {DENSITY:g} kg/m3; none at all for the base.")
    lines.append("Efforts that nobody gives are placeholders that hold estimated masses; so are speeds of joints whose")
    return [*lines, "axes have no known one."]


def machine_data(machine: Machine, selection: Selection) -> tuple[str, ...]:
    """Return the machine data that a file gives for a kinematic, a line each."""
    given = [row for row in machine.parameters(selection.kinematic, selection.channel) if row.given]
    lines = [
        f"{array_name(group)} = {', '.join(_value(row) for row in group)} {group[0].unit}".rstrip()
        for group in arrays_of(given)
    ]
    if selection.tool_length_mm:
        lines.append(f"added tool length = {number_text(selection.tool_length_mm)} mm")
    return tuple(lines)


def _value(row: ParameterRow) -> str:
    return f"{row.value:.15g}" if isinstance(row.value, float) else str(row.value)


def mjcf_header(chain: Chain) -> str:
    """Return the header comment of an MJCF as plain text lines, without folder and date."""
    lines = [
        f"{chain.title}: {chain.kinematic} ({chain.dialect}), written by chainbuild.",
        "",
        "Metres, radians, kilograms. The sites tool and workpiece are the tips: a programmed pose is tool seen from",
        "workpiece. Actuators are the axes: a control is an axis value in metres or radians.",
        *_joint_values(chain),
        "Masses are those given."
        if chain.geometry.inertias
        else "Masses are ESTIMATES: the bodies, solid, of one density.",
        "Stiffness of drives and inertia of rotors are estimates. Bodies do not collide.",
    ]
    if not isinstance(chain.axis_map, AffineMap):
        joints = {joint.name for joint in chain.joints}
        lacking = [axis.name for axis in chain.axes if axis.name not in joints]
        if not chain.loops:
            lines.append("Drives move joints, not axes: the nonlinear map between them is not expressed by this file.")
        if lacking:
            lines.append(f"Without a drive, for want of a joint of their own: {', '.join(lacking)}.")
    return "\n".join(_safe(line) for line in lines)


def _joint_values(chain: Chain) -> list[str]:
    lines = axis_map_in_words(chain)
    same = "Joint values are the controller's axis values in metres and radians, by name"
    if not lines:
        return [f"{same}."]
    if chain.loops and not isinstance(chain.axis_map, AffineMap):
        return [
            "Joints with the names of axes stand at axis values, in metres and radians; the others follow from closing",
            "the loops.",
        ]
    if not isinstance(chain.axis_map, AffineMap):
        return ["The joint values of this file are Pinocchio's q:", *(f"  {line}" for line in lines)]
    return [f"{same}, except these (from mm and degrees):", *(f"  {line}" for line in lines)]


def _safe(line: str) -> str:
    """Return a line that is valid in an XML comment: printable, no double hyphen, no hyphen at its end."""
    printable = "".join(c if c.isprintable() else " " for c in line)
    while "--" in printable:
        printable = printable.replace("--", "- -")
    return f"{printable} " if printable.endswith("-") else printable
