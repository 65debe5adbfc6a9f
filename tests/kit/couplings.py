"""Lists of couplings: a robot on an XY unit, alone and at a rotary/swivel table."""

from __future__ import annotations

from tests.kit.universal import TABLE, XY_UNIT, robot_lines

XY_GROUP = [
    "trafo[2].id 210", "trafo[2].group[0].name LIN_ROB", "trafo[2].group[0].chain[0] LINEAR",
    "trafo[2].group[0].chain[1] ROBOT", "trafo[2].group[0].move_prio[0] LINEAR (first",
    "trafo[2].group[0].move_prio[1] ROBOT",
]  # fmt: skip
XY = [*robot_lines(0), *XY_UNIT.lines(1, name="LINEAR"), *XY_GROUP]
AT_TABLE = [
    *XY, *TABLE.lines(3, name="TABLE"), "trafo[2].group[0].workpiece_cs TABLE", "trafo[2].group[1].name TABLE",
    "trafo[2].group[1].chain[0] TABLE",
]  # fmt: skip
