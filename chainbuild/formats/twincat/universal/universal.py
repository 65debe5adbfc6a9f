"""KIN_TYP 91, the universal kinematic: a list of axes becomes a chain.

    T = Π M(axis[chain[k]]),  M = t(q·o) or t(p)·Rot(o, q)·t(-p)
    tool tip = T·(zero_position - L·zero_orientation),  tool vector = R(T)·zero_orientation

Everything is entered in one coordinate system, that of the machine at zero. Axes met before the machine origin carry
the workpiece; their directions are entered multiplied by -1, so that the product is the pose. The list does not
mark them: the whole chain, from the workpiece to the tool, is rooted in the list's coordinate system.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.assemble import Element, Fixed, Move, assemble, mark, shift, turn
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.programmed.display import TOOL_COLUMNS, Display
from chainbuild.convention import Choices
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.source import DIALECT, Source
from chainbuild.formats.twincat.lists.toollist import acting_params
from chainbuild.formats.twincat.types.displays import by_angles, by_rotary_axes
from chainbuild.formats.twincat.types.draft import angle_mode, draft_name
from chainbuild.formats.twincat.universal.universal_data import UniversalAxis, UniversalData, check_mode, read_universal
from chainbuild.frames import inverse, rot_about, unit
from chainbuild.units import deg_from_rad

UNIVERSAL: Final = 91

_LETTERS: Final = {"linear": "XYZ", "rotary": "ABC"}
_FIRST_SPECIAL_MODE: Final = 10  # of P-CHAN-00112: those below are angle modes of every complete type
_VECTOR_MODE: Final = 10
# Programming modes of two angles: their letters, outer turn first, and what they turn to the tool vector.
_ANGLES_OF_TOOL: Final[Mapping[int, tuple[str, Literal["x", "y", "z"]]]] = {
    14: ("AB", "x"),
    15: ("BA", "y"),
    16: ("AC", "x"),
    17: ("CA", "z"),
    18: ("BC", "y"),
    19: ("CB", "z"),
    20: ("AB", "z"),
    21: ("BA", "z"),
}


def universal_draft(
    source: Source, choose: Choices, collector: Collector, *, member: bool = False, table: bool = False
) -> Chain:
    """Return the chain of KIN_TYP 91, its axes without limits.

    Args:
        source: The kinematic, its channel and tool.
        choose: Conventions.
        collector: Takes findings.
        member: True for a partial of a coupling.
        table: True where the kinematic carries the workpiece of another: entered from the workpiece to the machine
            origin, it is read backwards, so that the tool frame is the table's.

    Raises:
        MachineDataError: a value is not permitted, or the axes make no kinematic.
    """
    tool = acting_params(source.tool, source.trafo, collector)
    data = read_universal(source.trafo, tool, collector, member=member)
    axes = tuple(Axis.unlimited(name, axis.kind) for name, axis in zip(_axis_names(data.axes), data.axes, strict=True))
    moves = [element for k in data.chain for element in _motion(data, axes, k, choose, collector)]
    if table:
        moves = [_reversed(element) for element in reversed(moves)]
    end: list[Element] = [
        shift(*data.zero_position_mm),
        turn(_tool_frame(data.zero_orientation, choose)),
        mark("flange"),
        shift(z=-source.tool_length_mm),
    ]
    body, mode = assemble(axes, [*moves, *end]), _angle_mode(source, choose, collector)
    return Chain(
        name=draft_name(source),
        title=source.trafo.name or "Universal kinematic",
        dialect=DIALECT,
        kinematic=f"KIN_TYP {UNIVERSAL}",
        links=body.links,
        joints=body.joints,
        frames=body.frames,
        axes=axes,
        axis_map=body.axis_map,
        angle_mode=mode,
        display=_display(data, source, axes, mode, collector),
    )


def _display(data: UniversalData, source: Source, axes: Sequence[Axis], mode: str, collector: Collector) -> Display:
    """Return what is displayed: by the programming mode, else rotary axes with RTCP, else pose angles.

    Modes 10 to 21 may also be given by P-CHAN-00112; `programming_mode` wins.
    """
    given, number = source.channel.angle_mode, data.mode
    special = int(given.value) if given and given.value >= _FIRST_SPECIAL_MODE else 0
    if special and given and not number:
        number = special
        check_mode(number, given.span, given.name)
    elif special and given and number != special:
        text = f"programming_mode {number} and ori_rotation_angle {special} differ; programming_mode is used"
        collector.add("CB419", text, span=given.span, parameter=given.name)
    if number in _ANGLES_OF_TOOL:
        letters, along = _ANGLES_OF_TOOL[number]
        columns = tuple(f"{letter.lower()}_deg" for letter in letters)
        return Display("direction", columns, letters=letters, along=along, rtcp=data.rtcp)
    if number == _VECTOR_MODE:
        return Display("vector", TOOL_COLUMNS, rtcp=data.rtcp)
    if number or data.rtcp:
        return replace(by_rotary_axes(axes), rtcp=data.rtcp)
    return by_angles(mode)


def _motion(data: UniversalData, axes: Sequence[Axis], k: int, choose: Choices, collector: Collector) -> list[Element]:
    """Return the elements of one axis, in the order from the workpiece."""
    axis, name = data.axes[k], axes[k].name
    x, y, z = unit(axis.orientation)
    if axis.kind == "rotary":
        move = Move(name, "revolute", (x, y, z), {name: 1.0})
        return [shift(*axis.point_mm), move, shift(*-axis.point_mm)]
    factor = _stretch(axis, name, choose, collector)
    if data.linkage is None:
        return [Move(name, "prismatic", (x, y, z), {name: factor})]
    linear = [n for n, one in enumerate(data.axes) if one.kind == "linear"]
    row = data.linkage[linear.index(k)] * factor
    drive = {axes[n].name: float(value) for n, value in zip(linear, row[:3], strict=True)}
    return [Move(name, "prismatic", (x, y, z), drive, float(row[3]))]


def _reversed(element: Element) -> Element:
    """Return the inverse of a constant transform or of an axis."""
    if isinstance(element, Fixed):
        return Fixed(inverse(element.T))
    if isinstance(element, Move):
        x, y, z = (-component + 0.0 for component in element.direction)
        return Move(element.name, element.kind, (x, y, z), element.drive, element.offset)
    return element


def _stretch(axis: UniversalAxis, name: str, choose: Choices, collector: Collector) -> float:
    """Return how far one millimetre of a linear axis goes: the length of its vector, or 1."""
    length = float(np.linalg.norm(axis.orientation))
    if abs(length - 1.0) < 1e-12:
        return 1.0
    scaled = choose["kin91_linear_length"] == "scales"
    effect = f"the axis moves {length:.9g} mm per millimetre" if scaled else "its length is ignored"
    text = f"the direction of the linear axis {name} has the length {length:.9g}; {effect}"
    collector.add("CB453", text, span=axis.span, hint="enter a unit vector, or set convention kin91_linear_length")
    return length if scaled else 1.0


def _tool_frame(zero_orientation: Vector, choose: Choices) -> Matrix:
    """Return the rotation whose z axis is the tool vector at zero."""
    x, y, z = zero_orientation
    if np.allclose(zero_orientation, (0.0, 0.0, 1.0), atol=1e-15):
        return np.eye(3)
    if choose["kin91_tool_frame"] == "x_in_zx_plane":
        along_y = abs(y) > 1.0 - 1e-12
        column_x = np.array([1.0, 0.0, 0.0]) if along_y else unit((z, 0.0, -x))
        return np.column_stack([column_x, np.cross(zero_orientation, column_x), zero_orientation])
    if np.hypot(x, y) < 1e-12:
        return rot_about((1.0, 0.0, 0.0), 180.0)
    return rot_about((-y, x, 0.0), deg_from_rad(float(np.arctan2(np.hypot(x, y), z))))


def _axis_names(axes: Sequence[UniversalAxis]) -> list[str]:
    """Return the axis letters: by the coordinate axis each is nearest to, numbered where one comes twice.

    The list names no axes; the letters are those of the other types.
    """
    letters = [_LETTERS[axis.kind][int(np.argmax(np.round(np.abs(axis.orientation), 9)))] for axis in axes]
    count, seen = Counter(letters), Counter[str]()
    names = []
    for letter in letters:
        seen[letter] += 1
        names.append(f"{letter}{seen[letter]}" if count[letter] > 1 else letter)
    return names


def _angle_mode(source: Source, choose: Choices, collector: Collector) -> str:
    """Return how poses are shown; the special modes of 91 say how its angles are programmed, not that."""
    given = source.channel.angle_mode
    special = given is not None and given.value >= _FIRST_SPECIAL_MODE
    return angle_mode(None if special else given, choose, collector)
