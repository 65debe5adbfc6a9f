r"""KIN_TYP 11, 33, 76: heads with an inclined axis that passes through, or close to, the tool tip.

Seen along -X at zero (11)::

          B axis, inclined by HD3 in the YZ plane
            \     |
             \   [ ] clamped tool, HD1 below the head's reference point
              \   |
               \  |   tool length
                \ |
                 \|  ideal length HD2: here B, A and the tool tip meet
      ────────────o──────────── A axis of the workpiece
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild import tolerances
from chainbuild.chain.assemble import linear, mark, shift
from chainbuild.convention import Choices
from chainbuild.formats.twincat.maps.drives import BevelAxes, BevelDrives
from chainbuild.formats.twincat.recipes.head_parts import slides
from chainbuild.formats.twincat.recipes.parts import asked_sign, tool_end
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven, table_rotary
from chainbuild.frames import cos_sin_deg

# Direction of the inclined axis of 33 as (x, y) share of the sine of the tilt.
_TILT: Final = {"xz_plus": (1.0, 0.0), "xz_minus": (-1.0, 0.0), "yz_plus": (0.0, 1.0), "yz_minus": (0.0, -1.0)}

_BEVEL: Final[Mapping[str, BevelAxes]] = {"b_outside": "b_outside", "a_outside": "a_outside", "upright": "upright"}


def kin_11(p: Params, choose: Choices) -> Recipe:
    """Build the oblique B head over a workpiece on Z and A."""
    cosine, sine = cos_sin_deg(p.deg("tilt_angle"))
    lean = asked_sign(choose, "kin11_tilt_sign", sine) * sine
    counts = p.mm("tool_z") != 0 and choose["kin11_ideal_length"] == "with_hd1"
    return Recipe(
        tool=[
            linear("X", "x"),
            linear("Y", "y"),
            driven("B", (0.0, lean, cosine), Drive()),
            *tool_end(p, z=p.mm("ideal_tool_length") - (p.mm("tool_z") if counts else 0.0)),
        ],
        workpiece=[linear("Z", "z", sign=-1.0), table_rotary(choose, "A", "x")],
    )


def kin_33(p: Params, choose: Choices) -> Recipe:
    """Build the C head with an inclined A, both through the tool tip."""
    cosine, sine = cos_sin_deg(p.deg("tilt_angle"))
    x, y = _TILT[choose["kin33_tilt_axis"]] if sine else (0.0, 0.0)
    length = p.tool_length_mm
    counts = length != 0 and choose["kin33_tool_length"] == "along_tool"
    if length and not counts:
        text = f"the tool length of {length:g} mm has no effect: the head keeps the tool tip by its mechanics"
        p.note("CB407", "tilt_angle", text, hint="convention kin33_tool_length=along_tool lets it count")
    return Recipe(
        tool=[
            *slides(p, choose),
            driven("C", "z", Drive(1.0, 180.0 * p.flag("head_reversed"))),
            driven("A", (x * sine, y * sine, cosine), Drive()),
            mark("flange"),
            shift(z=-length if counts else 0.0),
        ],
    )


def kin_76(p: Params, choose: Choices) -> Recipe:
    """Build the mechanically compensated bevel head from its programmed angles C and A.

    The inclined machine axes behind them (HD6, HD7) keep the tool point, so that the pose does not depend on them.
    """
    x, y, z = (p.mm(f"tcp_to_machine_{axis}") for axis in "xyz")
    s = asked_sign(choose, "kin76_offset_sign", x, y, z)
    text = "C and A are the programmed angles; the inclined axes A and B of the machine are not part of the model"
    p.note("CB423", "tilt_angle", text, hint="HD6 and HD7 bound what they reach; give limits of A in the overlay")
    return Recipe(
        tool=[
            *slides(p, choose),
            shift(s * x, s * y, s * z),
            driven("C", "z", Drive()),
            driven("A", "x", Drive()),
            *tool_end(p, z=-p.mm("tool_z")),
        ],
        drives=_bevel_drives(p, choose),
    )


def _bevel_drives(p: Params, choose: Choices) -> BevelDrives | None:
    """Return the machine axes of 76; None where HD7 is 0 or 180 degrees: the head could not lean."""
    tilt, mounting = p.deg("tilt_angle"), p.deg("mounting_angle")
    if abs(cos_sin_deg(tilt)[1]) < tolerances.ZERO_VECTOR:
        return None
    sign = asked_sign(choose, "kin76_hd6_sign", mounting)
    return BevelDrives(tilt, sign * mounting, _BEVEL[choose["kin76_machine_axes"]])


RECIPES: Final[Mapping[int, RecipeFunction]] = {11: kin_11, 33: kin_33, 76: kin_76}
