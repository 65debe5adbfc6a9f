"""Parallel kinematics: tripods (12, 209), the delta robot (37), the lambda kinematic (21), the table on rods (19).

The tool's branch is what the platform does: three shifts, driven by the closed form of the map. Each arm is a branch of
its own with one rod for its pair, which ends at a pin of the platform: a loop, closed by a ball.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from chainbuild.chain.assemble import Element, Start, linear, mark, rotary, shift, turn
from chainbuild.chain.elements import Axis, Loop
from chainbuild.convention import Choices
from chainbuild.formats.twincat.maps.arms import Column, Lever
from chainbuild.formats.twincat.maps.scissors import LambdaMap
from chainbuild.formats.twincat.maps.struts import ThreeRodsMap
from chainbuild.formats.twincat.maps.table import LINK_RISE, TableMap
from chainbuild.formats.twincat.maps.table_rods import TableRods
from chainbuild.formats.twincat.recipes.parts import asked_sign, flagged_axis, offset, tool_end
from chainbuild.formats.twincat.recipes.recipe import Params, Recipe, RecipeFunction, mapped
from chainbuild.frames import rot_z, transform, translation
from chainbuild.units import m_from_mm, rad_from_deg

_AZIMUTH: Final = {"deg_0": 0.0, "deg_90": 90.0, "deg_180": 180.0, "deg_minus_90": -90.0}  # choices → degrees
_BETWEEN_DEG: Final = 120.0  # columns or arms of an ideal machine
_WHOLE_DEG: Final = 360.0  # what the three angles between columns add up to
_POST_SHARE: Final = 0.25  # of the radius: how far the links of a table's guide are hinged below and above its joints


def kin_12(p: Params, choose: Choices) -> Recipe:
    """Build the tripod: three carriages on columns carry a platform that does not turn."""
    return _tripod(p, choose, 0.0)


def kin_209(p: Params, choose: Choices) -> Recipe:
    """Build the tripod over a table of two rotary axes: A (B) carries C."""
    angle = p.deg("column_angle")
    how = choose["kin209_column_angle"] if angle else "columns"
    second = flagged_axis(p, choose, "A", "y" if p.flag("second_axis_b") else "x")
    axes = p.axes
    if p.flag("second_axis_b"):
        second = replace(second, name="B", drive={"B": second.drive["A"]})
        axes = tuple(replace(axis, name="B") if axis.name == "A" else axis for axis in axes)
    table: list[Element] = [
        offset(p, "machine_to_rotary"),
        second,
        offset(p, "rotary_to_c"),
        flagged_axis(p, choose, "C", "z"),
    ]
    if how != "columns":
        table.insert(0, turn(rot_z(angle if how == "table" else -angle)))
    return replace(_tripod(p, choose, angle if how == "columns" else 0.0, beside=2), workpiece=table, axes=axes)


def kin_37(p: Params, choose: Choices) -> Recipe:
    """Build the delta robot: three levers, turned by motors at the top, carry a platform that does not turn."""
    base, platform, rod, lever = (
        p.mm(name) for name in ("base_radius", "platform_radius", "rod_length", "lever_length")
    )
    _check_rods(p, rod_length=rod, lever_length=lever)
    order = -1.0 if choose["kin37_numbering"] == "cw" else 1.0
    first = _AZIMUTH[choose["kin37_azimuth"]]
    zeros = [p.deg(f"zero_j{n}") for n in (1, 2, 3)]
    arms = [
        Lever(first + order * _BETWEEN_DEG * n, m_from_mm(base - platform), m_from_mm(lever), zeros[n])
        for n in range(3)
    ]
    branches = [
        [
            turn(rot_z(arm.angle_deg)),
            shift(x=base),
            rotary(f"J{n}", "y", offset_deg=-arm.zero_deg),
            shift(x=lever),
            *_rod(f"J{n}", rod, hanging=1.0),
        ]
        for n, arm in enumerate(arms, start=1)
    ]
    tool_z, zero_z = p.mm("tool_z"), p.mm("machine_zero_z")
    z = tool_z * asked_sign(choose, "kin37_hd1_sign", tool_z) + zero_z * asked_sign(choose, "kin37_hd13_sign", zero_z)
    tool = [
        *_platform([(f"J{n}", arm.angle_deg) for n, arm in enumerate(arms, start=1)], platform),
        shift(z=z),
        mark("flange"),
        shift(z=-p.tool_length_mm),
    ]
    axis_map = ThreeRodsMap(tuple(arms), m_from_mm(rod), 1.0, names=("J1", "J2", "J3"))
    axes = _limited(p, choose, zeros)
    return Recipe(tool, axes=axes, axis_map=axis_map, branches=branches, loops=_loops("J1", "J2", "J3"))


def _limited(p: Params, choose: Choices, zeros: list[float]) -> tuple[Axis, ...]:
    """Return the axes of the delta robot with the limits that HD11 and HD12 give; both 0: none."""
    lower, upper = p.deg("joint_lower"), p.deg("joint_upper")
    if not (lower or upper):
        return p.axes
    if lower >= upper:
        p.refuse(
            "joint_lower", f"the joint limits are {lower:g} and {upper:g} deg", "the lower one below the upper one"
        )
        return p.axes
    shifts = zeros if any(zeros) and choose["kin37_limits_of"] == "lever" else [0.0] * len(zeros)
    return tuple(
        replace(axis, lower=lower + shift_deg, upper=upper + shift_deg, assumed=False)
        for axis, shift_deg in zip(p.axes, shifts, strict=True)
    )


def _tripod(p: Params, choose: Choices, turned_deg: float, beside: int = 0) -> Recipe:
    """Return the tripod, its columns turned about Z, with rotary axes of a table beside it."""
    columns, platform, rod = (p.mm(name) for name in ("column_radius", "platform_radius", "rod_length"))
    _check_rods(p, rod_length=rod)
    if columns == platform:
        text = f"the radii of columns and platform are both {columns:g} mm: the rods are parallel, and hold nothing"
        p.refuse("platform_radius", text, "another radius than that of the columns")
    order = -1.0 if choose["kin12_numbering"] == "cw" else 1.0
    hanging = -1.0 if choose["kin12_carriages"] == "below" else 1.0
    up = -1.0 if choose["kin12_z_positive"] == "down" else 1.0
    third = _AZIMUTH[choose["kin12_azimuth"]] + turned_deg
    before, behind = _between(p)
    angles = (third + order * before, third - order * behind, third)
    arms = [Column(angle, m_from_mm(columns - platform), up) for angle in angles]
    branches = [
        [
            turn(rot_z(angle)),
            shift(x=columns),
            linear(f"Z{n}", "z", sign=up),
            *_rod(f"Z{n}", rod, hanging=hanging),
        ]
        for n, angle in enumerate(angles, start=1)
    ]
    pins = [(f"Z{n}", angle) for n, angle in enumerate(angles, start=1)]
    tool = [*_platform(pins, platform), shift(*_tool_offset(p, choose)), mark("flange"), shift(z=-p.tool_length_mm)]
    axis_map = ThreeRodsMap(tuple(arms), m_from_mm(rod), hanging, beside, ("Z1", "Z2", "Z3"))
    return Recipe(tool, axis_map=axis_map, branches=branches, loops=_loops("Z1", "Z2", "Z3"))


def _tool_offset(p: Params, choose: Choices) -> tuple[float, float, float]:
    """Return the way from the platform to the clamping point [mm]."""
    x, y = p.mm("tool_x"), p.mm("tool_y")
    if (x or y) and choose["kin12_tool_xy"] == "swapped":
        x, y = y, x
    sign = asked_sign(choose, "kin12_tool_xy_sign", x, y)
    zero = p.mm("machine_zero_z")
    return sign * x, sign * y, -p.mm("tool_z") + zero * asked_sign(choose, "kin12_hd4_sign", zero)


def _between(p: Params) -> tuple[float, float]:
    """Return the angles from column 3 to column 1, and back to column 2 [deg]."""
    before, behind = p.deg("angle_31"), p.deg("angle_32")
    if not p.flag("not_ideal"):
        if before or behind:
            p.note("CB436", "angle_31", "HD9 and HD10 have no effect: HD8 = 0 is the ideal tripod, 120 deg apart")
        return _BETWEEN_DEG, _BETWEEN_DEG
    if before <= 0.0 or behind <= 0.0 or before + behind >= _WHOLE_DEG:
        text = f"the angles between the columns are {before:g} and {behind:g} deg"
        p.refuse("angle_31", text, "both above 0, together below 360 deg")
    return before, behind


def _check_rods(p: Params, **lengths: float) -> None:
    for name, length in lengths.items():
        if length <= 0.0:
            p.refuse(name, f"{name.replace('_', ' ')} is {length:g} mm", "a length above 0")


def _platform(pins: list[tuple[str, float]], radius: float) -> list[Element]:
    """Return the three shifts of a platform with its pins at azimuths [deg] on a radius [mm]."""
    return [
        *(linear(f"platform_{letter}", letter, drive={}) for letter in "xyz"),
        *_pins(pins, radius),
    ]


def _pins(pins: list[tuple[str, float]], radius: float) -> list[Element]:
    return [mark(f"{name}_pin", transform(rot_z(angle)) @ translation(x=radius)) for name, angle in pins]


def _rod(name: str, length: float, hanging: float, leans: bool = True) -> list[Element]:
    """Return the joints of a rod that hangs down (or stands up) at 0, and its end."""
    return [
        mapped(f"{name}_swing", "y"),
        *([mapped(f"{name}_lean", "x")] if leans else []),
        shift(z=-hanging * length),
        mark(f"{name}_rod_end"),
    ]


def _loops(*names: str) -> tuple[Loop, ...]:
    return tuple(Loop(f"{name}_rod", "ball", f"{name}_rod_end", f"{name}_pin") for name in names)


def kin_21(p: Params, choose: Choices) -> Recipe:
    """Build the lambda kinematic: two slides along X move two rods; one of them carries Z and C at its end."""
    rod_b, rod_c, gap = p.mm("rod_b"), p.mm("rod_c"), p.mm("joint_offset")
    _check_rods(p, rod_b=rod_b, rod_c=rod_c)
    for key in ("angle_lower", "angle_upper", "variant"):
        if p.given(key):
            p.note("CB437", key, f"HD{p.data.row(key).n} is read, but not applied: the drawing that defines it is lost")
    start = p.mm("offset_x") * asked_sign(choose, "kin21_hd10_sign", p.mm("offset_x"))
    across = choose["kin21_hd5_along"] == "y" if gap else True
    along, beside = (0.0, gap) if across else (gap, 0.0)
    y, beta = p.mm("slide_y"), p.deg("fixed_angle")
    beta *= asked_sign(choose, "kin21_beta_sign", beta)
    first = choose["kin21_slides"] == "x1_carries_c"
    c, b = ("X1", "X2") if first else ("X2", "X1")
    by_arm = choose["kin21_c_zero"] == "along_arm"
    tool: list[Element] = [
        shift(start, y),
        linear(c, "x"),
        rotary("theta", "z", drive={}),
        mark("C_rod_end", translation(x=rod_c)),
        turn(rot_z(beta)),
        shift(p.mm("gripper_arm")),
        linear("Z", "z"),
        rotary("C", "z") if by_arm else mapped("C_turn", "z"),
        shift(p.mm("gripper_offset"), z=-p.mm("tool_z")),
        mark("flange"),
        shift(z=-p.tool_length_mm),
    ]
    branch: list[Element] = [
        shift(start + along, y + beside),
        linear(b, "x"),
        rotary("phi", "z", drive={}),
        shift(rod_b),
        mark("B_rod_end"),
    ]
    axis_map = LambdaMap(
        (m_from_mm(start), m_from_mm(start + along)),
        (m_from_mm(y), m_from_mm(y + beside)),
        (m_from_mm(rod_c), m_from_mm(rod_b)),
        1.0 if choose["kin21_side"] == "left" else -1.0,
        (0, 1) if first else (1, 0),
        rad_from_deg(beta),
        by_arm,
    )
    return Recipe(tool, axis_map=axis_map, branches=[branch], loops=(Loop("rods", "ball", "C_rod_end", "B_rod_end"),))


def kin_19(p: Params, choose: Choices) -> Recipe:
    """Build the table on three rods: three carriages on columns tilt and lift it under a tool on two slides."""
    radial = choose["kin19_guide"] == "radial_planes"
    rod, table, columns = (p.mm(name) for name in ("rod_length", "table_radius", "column_radius"))
    _check_rods(p, rod_length=rod, table_radius=table, column_radius=columns)
    if rod <= abs(columns - table):
        text = f"rods of {rod:g} mm do not reach from {columns:g} mm, the radius of the columns, to {table:g} mm"
        p.refuse("rod_length", text, f"more than {abs(columns - table):g} mm")
    order = -1.0 if choose["kin19_numbering"] == "cw" else 1.0
    hanging = 1.0 if choose["kin19_carriages"] == "above" else -1.0
    first = _AZIMUTH[choose["kin19_azimuth"]]
    angles = [first + order * _BETWEEN_DEG * n for n in range(3)]
    pins = [(f"Z{n}", angle) for n, angle in enumerate(angles, start=1)]
    branches: list[Sequence[Element]] = [
        [turn(rot_z(angle)), shift(x=columns), linear(name, "z"), *_rod(name, rod, hanging, leans=not radial)]
        for name, angle in pins
    ]
    loops = _loops("Z1", "Z2", "Z3")
    if not radial:
        branches += [
            _link("guide_lower", "guide_post", first, -table),
            _link("guide_upper", "guide_table", first, table),
        ]
        loops += (Loop("guide", "ball", "guide_lower_end", "guide_upper_end"),)
    workpiece = [
        linear("table_z", "z", drive={}),
        *([linear("table_x", "x", drive={}), linear("table_y", "y", drive={})] if radial else []),
        mark("guide_post"),
        *(mapped(f"table_{letter}", direction) for letter, direction in zip("abc", "xyz", strict=True)),
        mark("guide_table"),
        *_pins(pins, table),
        shift(z=p.mm("table_height")),
    ]
    tool = [linear("X", "x"), linear("Y", "y"), *tool_end(p, z=-p.mm("tool_z"))]
    rods = TableRods.of(angles, m_from_mm(table), m_from_mm(columns), m_from_mm(rod), hanging, radial)
    return Recipe(tool, workpiece, axis_map=TableMap(rods), branches=branches, loops=loops)


def _link(name: str, start: str, azimuth_deg: float, radius: float) -> list[Element]:
    """Return a link that keeps a table from turning, opposite to an azimuth: below its joints, or above."""
    height = _POST_SHARE * radius
    return [
        Start(start),
        turn(rot_z(azimuth_deg + _WHOLE_DEG / 2.0)),
        shift(z=height),
        mapped(name, "y"),
        shift(x=abs(height) / LINK_RISE),
        mark(f"{name}_end"),
    ]


RECIPES: Final[Mapping[int, RecipeFunction]] = {12: kin_12, 19: kin_19, 21: kin_21, 37: kin_37, 209: kin_209}
