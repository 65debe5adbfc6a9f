r"""KIN_TYP 59, 60: the cardanic head, C outside and an axis inside that leans by HD7 from Z (59: to X, 60: to Y).

Seen along -Y (60: along -X) at zero::

      X, Y, Z ──o  M
                |  HD11, HD12, HD13
                C   about Z
                |  HD8, HD9, HD10
                A──.   inclined by HD7
                |    \
                o SP   HD4, HD5, HD6 back to A; in the ideal head SP lies on A
                |  HD1 down, HD2 (x), HD3 (y)
               [ ] clamped tool; tool length down
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from chainbuild import tolerances
from chainbuild.chain.assemble import Element, Move, shift, turn
from chainbuild.chain.drives import AffineDrives, DriveMap
from chainbuild.convention import Choices
from chainbuild.formats.twincat.maps.drives import SpatialDrives
from chainbuild.formats.twincat.maps.heads import SpatialAnglesMap
from chainbuild.formats.twincat.recipes.head_parts import flip, slides, towards_slide, zero_deg
from chainbuild.formats.twincat.recipes.parts import asked_sign, tool_end
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven, mapped
from chainbuild.frames import cos_sin_deg, rot_about, rot_z
from chainbuild.units import deg_from_rad, rad_from_deg

# Values of HD20 of 59.
_UNDERFLOOR: Final = 1
_SAW: Final = 2


def kin_59(p: Params, choose: Choices) -> Recipe:
    """Build the C/A head; HD19 and HD20 fit a saw blade or an underfloor cutter to it."""
    cosine, sine = cos_sin_deg(p.deg("tilt_angle"))
    angles = _angles(p, choose, _offsets_59(p, choose))
    head = _Head("A", (sine, 0.0, cosine), "sp_to_a", "a_to_c")
    before, after = _options(p, choose, head, angles)
    return _recipe(p, choose, head, angles, before, after)


def kin_60(p: Params, choose: Choices) -> Recipe:
    """Build the C/B head."""
    cosine, sine = cos_sin_deg(p.deg("tilt_angle"))
    side = asked_sign(choose, "kin60_tilt_sign", sine)
    offsets = _Offsets(("internal_offset_c",), ("internal_offset_b",))
    angles = _angles(p, choose, offsets, side, "B")
    return _recipe(p, choose, _Head("B", (0.0, side * sine, cosine), "sp_to_b", "b_to_c"), angles, [], [])


@dataclass(frozen=True, slots=True)
class _Head:
    """What distinguishes 59 and 60: the inner axis, its direction, and the names of its offsets."""

    inner: str
    direction: tuple[float, float, float]
    point_to_inner: str
    inner_to_c: str


@dataclass(frozen=True, slots=True)
class _Offsets:
    """Names of the zero offsets of C and of the inner axis.

    Attributes:
        c: Those of C that the pose of given axis values contains.
        inner: Those of the inner axis.
        acting: Those that act like a zero offset on the drives, of C and of the inner axis; empty: none.
    """

    c: tuple[str, ...]
    inner: tuple[str, ...]
    acting: tuple[str, ...] = ()


def _offsets_59(p: Params, choose: Choices) -> _Offsets:
    internal, acting = ("internal_offset_c", "internal_offset_a"), ("offset_c", "offset_a")
    if flip(choose, "kin59_zero_offset", "not_in_pose", *(p.deg(key) for key in acting)) < 0:
        return _Offsets(internal[:1], internal[1:], acting)
    return _Offsets((internal[0], acting[0]), (internal[1], acting[1]), acting)


@dataclass(frozen=True, slots=True, eq=False)
class _Angles:
    """How the channel's angles become the joints' angles.

    Attributes:
        zero_deg: Offsets of C and of the inner axis, taken off machine angles.
        spatial: The map of programmed spatial angles, None where machine angles are programmed.
        drives: What the drives stand at, None where at the axis values.
    """

    zero_deg: tuple[float, float]
    spatial: SpatialAnglesMap | None
    drives: DriveMap | None = None


def _angles(p: Params, choose: Choices, offsets: _Offsets, side: float = 1.0, axis: str = "A") -> _Angles:
    c = math.fsum(zero_deg(p, choose, key) for key in offsets.c)
    inner = math.fsum(zero_deg(p, choose, key) for key in offsets.inner)
    acting = [zero_deg(p, choose, key) for key in offsets.acting] or [0.0, 0.0]
    tilt = p.deg("tilt_angle")
    if p.flag("machine_angles"):
        # Where the pose does not contain them, the axis values are programmed ones and the drives contain them.
        contained = not offsets.acting or offsets.acting[0] in offsets.c
        return _Angles((c, inner), None, None if contained else _shifted(*acting))
    if abs(cos_sin_deg(tilt)[1]) < tolerances.ZERO_VECTOR:
        text = f"with HD7 = {tilt:g} degrees the inner axis is parallel to C: the head cannot tilt the tool"
        p.refuse("tilt_angle", text, "an angle other than 0 and 180 degrees, typically 30 to 60")
        return _Angles((c, inner), None)
    exact = flip(choose, "spatial_angle_offsets", "direction_exact", c, inner) < 0
    taken = (0.0, 0.0) if exact else (c, inner)
    spatial = SpatialAnglesMap.of(tilt, taken, side, axis)
    return _Angles((c, inner), spatial, SpatialDrives(spatial, _drive_zeros(p, choose, offsets, taken, acting, exact)))


def _drive_zeros(
    p: Params, choose: Choices, offsets: _Offsets, taken: tuple[float, float], acting: Sequence[float], exact: bool
) -> tuple[float, float]:
    """Return what the drives C and the inner one stand beyond the angles of their joints [deg]."""
    if exact:  # the model takes all of them off the drives
        keys = (("internal_offset_c",), (offsets.inner[0],))
        own = [math.fsum(zero_deg(p, choose, key) for key in group) for group in keys]
        return own[0] + acting[0], own[1] + acting[1]
    moved = flip(choose, "kin59_drive_offset", "contained", *acting) > 0
    return (taken[0] + acting[0], taken[1] + acting[1]) if moved else taken


def _shifted(c: float, inner: float) -> AffineDrives | None:
    """Return drives that stand beyond their axis values by constants, None where these are 0."""
    return AffineDrives.shifted(5, {3: c, 4: inner}) if c or inner else None


def _recipe(
    p: Params, choose: Choices, head: _Head, angles: _Angles, before: Sequence[Element], after: Sequence[Element]
) -> Recipe:
    """Return the chain; `before` and `after` enclose the innermost shift."""
    machine = _vector(p, "c_to_machine")
    inner, point = _vector(p, head.inner_to_c), _vector(p, head.point_to_inner)
    s = towards_slide(choose, *(length for vector in (machine, inner, point) for length in vector[:2]))
    clamp = p.mm("tool_x"), p.mm("tool_y")
    to_clamp = asked_sign(choose, "clamp_offset_sign", *clamp)
    joint_c, joint_inner = _joints(head, angles)
    tool = [
        *slides(p, choose),
        _back(machine, s),
        joint_c,
        _back(inner, s),
        joint_inner,
        _back(point, s),
        *before,
        *tool_end(p, to_clamp * clamp[0], to_clamp * clamp[1], -p.mm("tool_z")),
        *after,
    ]
    if angles.spatial is None:
        return Recipe(tool=tool, drives=angles.drives)
    text = (
        f"C and {head.inner} are spatial angles (HD21 = 0): a URDF file holds the machine angles that follow from them"
    )
    p.note("CB421", "machine_angles", text)
    lean = deg_from_rad(angles.spatial.largest_tilt)
    axes = tuple(replace(axis, lower=-lean, upper=lean) if axis.name == head.inner else axis for axis in p.axes)
    return Recipe(tool=tool, axes=axes, axis_map=angles.spatial, drives=angles.drives)


def _joints(head: _Head, angles: _Angles) -> tuple[Move, Move]:
    """Return C and the inner joint: spatial angles move both by a map, machine angles each by its axis."""
    if angles.spatial is not None:
        return mapped("C", "z"), mapped(head.inner, head.direction)
    c, inner = (Drive(1.0, -zero) for zero in angles.zero_deg)
    return driven("C", "z", c), driven(head.inner, head.direction, inner)


def _vector(p: Params, stem: str) -> tuple[float, float, float]:
    return p.mm(f"{stem}_x"), p.mm(f"{stem}_y"), p.mm(f"{stem}_z")


def _back(vector: tuple[float, float, float], s: float) -> Element:
    """Return the way back along an offset 'from P to Q': its height is positive in any case."""
    x, y, z = vector
    return shift(-s * x, -s * y, -z)


def _options(p: Params, choose: Choices, head: _Head, angles: _Angles) -> tuple[list[Element], list[Element]]:
    """Return the elements that HD20 puts before and behind the innermost shift."""
    option = p.flag("option")
    if option == _UNDERFLOOR and p.deg("option_angle"):
        turns = choose["kin59_underfloor"] == "turns_tool"
        return [turn(rot_z(p.deg("option_angle")))] if turns else [], []
    if option != _SAW:
        return [], []
    radius = p.tool_radius_mm
    if radius == 0:
        text = "HD20 = 2 puts the tool point on the saw blade, but no blade radius is known: it stays at the centre"
        p.note("CB424", "option", text, hint="give the blade's radius with the tool")
        return [], []
    x, y = (1.0, 0.0)
    if choose["kin59_saw_tcp"] == "lowest_point":
        x, y = _lowest(head.direction, _target_angle(p, choose, angles))
    return [], [shift(radius * x, radius * y)]


def _target_angle(p: Params, choose: Choices, angles: _Angles) -> float:
    """Return the joint angle of A [deg] that belongs to the saw's target angle HD19."""
    target = p.deg("option_angle")
    if angles.spatial is None or (target and choose["kin59_saw_angle"] == "machine"):
        return target - angles.zero_deg[1]
    spatial = angles.spatial
    machine = spatial.machine_angle(rad_from_deg(target))
    if math.isnan(machine):
        lean = deg_from_rad(spatial.largest_tilt)
        p.refuse(
            "option_angle", f"the head cannot reach the target angle HD19 = {target:g} degrees", f"±{lean:g} degrees"
        )
        machine = 0.0
    return deg_from_rad(machine - spatial.zero[1])


def _lowest(direction: tuple[float, float, float], angle_deg: float) -> tuple[float, float]:
    """Return the direction, in the tool frame, from the blade's centre to its lowest tooth at an angle of A."""
    up = rot_about(direction, angle_deg)[2]  # e_z seen from the turned tool: the third row
    level = math.hypot(up[0], up[1])
    if level < tolerances.ZERO_VECTOR:
        return 1.0, 0.0
    return -float(up[0]) / level, -float(up[1]) / level


RECIPES: Final[Mapping[int, RecipeFunction]] = {59: kin_59, 60: kin_60}
