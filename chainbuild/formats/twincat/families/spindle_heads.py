"""KIN_TYP 3, 4, 5, 6: heads with several spindles or one from below, on a single rotary axis.

3, 4 at B = 0, along -Y::        5 from above at C + HD5 = 0::      6 along -X at C + HD4 = 0::

     [ ] upper spindle, 3            |  +Y                               C
      |                             [ ] active tool, HD1                 |___HD3___ +Y
      B   HD1 each way,              |                                   |        |
      |   HD3 (x), HD2 (y)     ──────C── HD2 or HD3 (x), HD4 down   HD2 down     [ ] tool up
     [ ] lower spindle, 4            |
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild.chain.assemble import Element, shift, turn
from chainbuild.chain.drives import AffineDrives
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.head_parts import flip, slides, towards_slide
from chainbuild.formats.twincat.recipes.parts import asked_sign, tool_end
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven
from chainbuild.frames import cos_sin_deg, rot_x

_B: Final = 3  # index of B in X, Y, Z, B


def kin_3(p: Params, choose: Choices) -> Recipe:
    """Build the double spindle head with the upper spindle: its tool points down at B = 180."""
    of_drive = choose["kin3_b_value"] == "drive"
    x = p.mm("tool_x")
    reversed_x = flip(choose, "kin3_offset_zero", "tool_up", x)
    return Recipe(
        tool=_double_spindle(p, choose, Drive(1.0, -180.0 if of_drive else 0.0), reversed_x * x),
        drives=None if of_drive else AffineDrives.shifted(len(p.axes), {_B: 180.0}),
    )


def kin_4(p: Params, choose: Choices) -> Recipe:
    """Build the double spindle head with the lower spindle."""
    return Recipe(tool=_double_spindle(p, choose, Drive(), p.mm("tool_x")))


def _double_spindle(p: Params, choose: Choices, b: Drive, tool_x: float) -> list[Element]:
    x = -towards_slide(choose, tool_x) * tool_x
    y = asked_sign(choose, "head_y_offset_sign", p.mm("tool_y")) * p.mm("tool_y")
    return [*slides(p, choose), driven("B", "y", b), *tool_end(p, x, y, -p.mm("tool_z"))]


def kin_5(p: Params, choose: Choices) -> Recipe:
    """Build the cross head for four tools; HD5 turns the active one to +Y."""
    side, down = _side_of_tool(p, choose), p.mm("tool_z")
    x = asked_sign(choose, "kin5_h_sign", side) * side
    z = asked_sign(choose, "kin5_hd4_sign", down) * down
    return Recipe(
        tool=[
            *slides(p, choose),
            driven("C", "z", Drive(1.0, p.deg("offset_c"))),
            shift(x, p.mm("tool_y"), z),
            turn(rot_x(90)),
            *tool_end(p),
        ],
    )


def _side_of_tool(p: Params, choose: Choices) -> float:
    """Return HD2 for tools 1 and 2 or HD3 for 3 and 4; which is active is read off its angle HD5."""
    tools_1_2, tools_3_4 = p.mm("tools_1_2_x"), p.mm("tools_3_4_x")
    if tools_1_2 == tools_3_4 == 0:
        return 0.0
    pairs = choose["kin5_spindle_pairs"]
    if pairs == "sum":
        return tools_1_2 + tools_3_4
    cosine, sine = cos_sin_deg(p.deg("offset_c"))
    first = abs(cosine) >= abs(sine) if pairs == "opposite" else cos_sin_deg(p.deg("offset_c") - 45.0)[0] > 0
    return tools_1_2 if first else tools_3_4


def kin_6(p: Params, choose: Choices) -> Recipe:
    """Build the under-floor milling head: the tool points up."""
    offset, down = p.deg("offset_c"), p.mm("tool_z")
    a_x, a_y = p.mm("a_to_c_x"), p.mm("a_to_c_y")
    s = towards_slide(choose, a_x, a_y)
    static = (a_x or a_y) and choose["kin6_a_axis_offset"] == "static"
    before, after = (shift(-s * a_x, -s * a_y), (0.0, 0.0)) if static else (shift(), (-s * a_x, -s * a_y))
    return Recipe(
        tool=[
            *slides(p, choose),
            before,
            driven("C", "z", Drive(1.0, asked_sign(choose, "kin6_hd4_sign", offset) * offset)),
            shift(after[0], p.mm("tool_y") + after[1], asked_sign(choose, "kin6_hd2_sign", down) * down),
            turn(rot_x(180)),
            *tool_end(p),
        ],
    )


RECIPES: Final[Mapping[int, RecipeFunction]] = {3: kin_3, 4: kin_4, 5: kin_5, 6: kin_6}
