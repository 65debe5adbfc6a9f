"""Configurations of KIN_TYP 210 that the controller refuses, by their error numbers."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from chainbuild.errors import ChainbuildError
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.coupling.coupling_groups import coupling_data
from tests.kit.couplings import AT_TABLE, XY, XY_GROUP
from tests.kit.twincat_files import chain_of, machine
from tests.kit.universal import XY_UNIT, robot_lines


def changed(old: str, new: str, lines: Sequence[str] = AT_TABLE) -> list[str]:
    assert any(old in line for line in lines), old
    return [line.replace(old, new) for line in lines]


SAME_NAME = changed("trafo[1].name LINEAR", "trafo[1].name ROBOT", changed("chain[0] LINEAR", "chain[0] ROBOT"))
NO_GROUP = [*XY[: -len(XY_GROUP)], "trafo[2].id 210"]
EMPTY_BY_ID = [*XY, "trafo[2].group[0].id 5", "trafo[2].group[1].id 6", "trafo[2].group[1].chain[0] 0"]
THREE_GROUPS = [*AT_TABLE, "trafo[2].group[2].name C", "trafo[2].group[2].chain[0] TABLE"]
FOUR_PARTIALS = [*AT_TABLE, *XY_UNIT.lines(4, name="MORE"), "trafo[2].group[1].chain[1] MORE"]

REFUSED = {
    "unsupported": ([*AT_TABLE, "trafo[0].type 36"], 292060, "KIN_TYP 36 (ROBOT) cannot be a partial"),
    "group twice": (changed("group[1].name TABLE", "group[1].name LIN_ROB"), 292063, "two groups are called LIN_ROB"),
    "unknown member": (changed("chain[1] ROBOT", "chain[1] ROBBI"), 292064, "ROBBI is not a configured kinematic"),
    "a coupling as member": (changed("chain[1] ROBOT", "chain[1] 210"), 292064, "210 is not a configured kinematic"),
    "unknown workpiece": (changed("workpiece_cs TABLE", "workpiece_cs DESK"), 292066, "DESK is not another group"),
    "own workpiece": (changed("workpiece_cs TABLE", "workpiece_cs LIN_ROB"), 292066, "LIN_ROB is not another group"),
    "incomplete priority": (changed("move_prio[1] ROBOT", "move_prio[1] 0"), 292067, "move_prio names 1 of 2 members"),
    "foreign priority": (
        changed("move_prio[1] ROBOT", "move_prio[1] TABLE"),
        292067,
        "TABLE is not a member of group[0]",
    ),
    "twice in priority": (changed("move_prio[1] ROBOT", "move_prio[1] LINEAR"), 292067, "names 1 of 2 members"),
    "no group": (NO_GROUP, 292085, "no group is configured"),
    "all groups 0": ([*NO_GROUP, "trafo[2].group[0].id 0", "trafo[2].group[0].chain[0] 45"], 292085, "no group"),
    "gap": (changed("group[0]", "group[1]", XY), 292086, "follows a group that is not configured"),
    "no members": ([*XY, "trafo[2].group[1].name EMPTY"], 292087, "group[1] has no members"),
    "no members by id": (EMPTY_BY_ID, 292087, "group[1] has no members"),
    "not unique": (SAME_NAME, 21931, "2 kinematics are called ROBOT"),
    "twice": (changed("group[1].chain[0] TABLE", "group[1].chain[0] ROBOT"), 21931, "ROBOT is listed twice"),
    "three groups": (THREE_GROUPS, None, "group[2] is one too many"),
    "four members": ([*XY, *(f"trafo[2].group[0].chain[{k}] ROBOT" for k in (2, 3))], None, "group[0] has 4 members"),
    "four partials": (FOUR_PARTIALS, None, "the coupling has 4 partial"),
    "circle": ([*AT_TABLE, "trafo[2].group[1].workpiece_cs LIN_ROB"], None, "each group follows the other"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str) -> None:
    lines, alarm, text = REFUSED[name]
    with pytest.raises(ChainbuildError) as caught:
        chain_of(lines)
    assert text in str(caught.value)
    assert caught.value.alarm == alarm
    assert caught.value.line
    assert "trafo[2]" in str(caught.value.parameter)
    assert caught.value.permitted
    assert caught.value.code == "CB455"


def test_a_tool_on_an_unknown_partial() -> None:
    text = "\n".join([*XY, "wz[1].kin_name GRIPPER"])
    with pytest.raises(ChainbuildError, match="unknown partial kinematic GRIPPER") as caught:
        machine(text, overlay=Overlay(tool={"number": 1.0})).chain()
    assert (caught.value.alarm, caught.value.permitted) == (22053, "LINEAR, ROBOT")


def test_a_coupling_in_the_second_step() -> None:
    lines = [*robot_lines(0), "kin_step[1].trafo[0].id 210", "kin_step[1].trafo[0].group[0].chain[0] ROBOT"]
    with pytest.raises(ChainbuildError, match="two steps") as caught:
        chain_of(lines, kinematic=210)
    assert caught.value.alarm == 22093


def test_every_error_of_the_configuration_is_raised_somewhere() -> None:
    errors = coupling_data()["errors"]
    assert {row["raised"] for row in errors.values()} == {"configuration", "program"}
    assert all(row["condition"].endswith(".") and row["title"] for row in errors.values())
    raised = {str(alarm) for _, alarm, _ in REFUSED.values() if alarm} | {"22053", "22093"}
    # 21630 belongs to every kinematic: tests of the configuration raise it.
    assert raised | {"21630"} == {number for number, row in errors.items() if row["raised"] == "configuration"}
    assert {"22091", "22092", "22094", "22122", "51065"} == set(errors) - raised - {"21630"}
