"""KIN_TYP 210: the manual's two configurations by hand formula, and every refusal of a configuration."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.poses import frame_placement
from chainbuild.errors import ChainbuildError
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.coupling.coupling_groups import coupling_data
from tests.kit.couplings import AT_TABLE, XY, XY_GROUP
from tests.kit.twincat_files import chain_of, codes, machine, pose
from tests.kit.universal import CA_HEAD, TABLE, XY_UNIT, XZ_UNIT, robot_lines, robot_pose, rotation, shift


def random_axes(count: int, rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(-150, 150, count)


def base(x: float = 0, y: float = 0, z: float = 0) -> np.ndarray:
    """Return a partial's system in the tool frame below: the offset leads down from there."""
    return shift((-x, -y, -z))


def test_robot_on_an_xy_unit() -> None:
    # 3.8.1, printed with base[2] = 20 mm for the robot and 10 mm for the unit.
    chain = chain_of([*XY, "trafo[0].base[2] 200000", "trafo[1].base[2] 100000"])
    assert [axis.name for axis in chain.axes] == ["X", "Y", "C1", "B1", "B2", "A1", "B3", "A2"]
    assert codes(chain) == ["CB454", "CB454"]
    rng = np.random.default_rng(1)
    for _ in range(100):
        axes = random_axes(8, rng)
        expected = base(z=10) @ XY_UNIT.product(axes[:2]) @ base(z=20) @ robot_pose(axes[2:])
        assert np.abs(pose(chain, axes) - expected).max() < 1e-9


def test_robot_on_a_unit_at_a_tilting_table() -> None:
    # 3.8.2: A carries C, and C the workpiece; the robot's coordinates count from there.
    lines = [
        line.replace("trafo[1].axis[1].orientation[1] 1.0", "trafo[1].axis[1].orientation[1] 0.0") for line in AT_TABLE
    ]
    lines = [
        line.replace("trafo[1].axis[1].orientation[2] 0.0", "trafo[1].axis[1].orientation[2] 1.0") for line in lines
    ]
    more = [
        "trafo[0].base[2] 200000",
        "trafo[1].base[2] 100000",
        "trafo[3].base[0] 30000000",
        "trafo[3].base[2] 10000000",
    ]
    chain = chain_of([*lines, *more])
    assert [axis.name for axis in chain.axes] == ["X", "Z", "C1", "B1", "B2", "A1", "B3", "A2", "A", "C"]
    assert [axis.carries for axis in chain.axes[8:]] == ["workpiece", "workpiece"]
    rng = np.random.default_rng(2)
    for _ in range(100):
        axes = random_axes(10, rng)
        tool = base(z=10) @ XZ_UNIT.product(axes[:2]) @ base(z=20) @ robot_pose(axes[2:8])
        table = base(3000, 0, 1000) @ rotation((1, 0, 0), axes[8]) @ rotation((0, 0, 1), axes[9])
        assert np.abs(pose(chain, axes) - np.linalg.inv(table) @ tool).max() < 1e-9


def test_the_table_as_entered() -> None:
    chain = chain_of(AT_TABLE, conventions={"kin210_table_frame": "as_entered"})
    axes = random_axes(10, np.random.default_rng(3))
    tool = XY_UNIT.product(axes[:2]) @ robot_pose(axes[2:8])
    assert np.abs(pose(chain, axes) - np.linalg.inv(TABLE.product(axes[8:])) @ tool).max() < 1e-9


def test_the_tool_keeps_its_place_on_the_turning_table() -> None:
    robot = chainbuild.Robot(chain_of(AT_TABLE))
    rng = np.random.default_rng(4)
    axes = np.array([100.0, 50.0, 10.0, -80.0, 70.0, 20.0, 40.0, 30.0, 0.0, 0.0])
    wanted = robot.fk(axes)
    in_table = np.linalg.inv(frame_placement(robot.chain, "workpiece", axes))
    here = frame_placement(robot.chain, "tool", axes)
    for _ in range(20):
        turned = axes.copy()
        turned[8:] = rng.uniform(-30, 30, 2)
        # What the robot has to do follows from the table alone …
        moved = frame_placement(robot.chain, "workpiece", turned) @ in_table @ here
        assert (
            np.abs(np.linalg.inv(frame_placement(robot.chain, "workpiece", turned)) @ moved - wanted.homogeneous).max()
            < 1e-12
        )
        # … and inverse kinematics with the table held comes to the same pose in the workpiece.
        found = robot.ik(wanted, start=turned, held={"A": turned[8], "C": turned[9]})
        assert found.success
        assert found.axes[8:] == pytest.approx(turned[8:], abs=1e-12)
        assert np.abs(robot.fk(found.axes).homogeneous - wanted.homogeneous).max() < 1e-8


def test_base_offsets_by_either_convention() -> None:
    # P-CHAN-00446: a slide raises the robot by 10 cm.
    lines = [*XY, "trafo[0].base[2] -1000000"]
    raised = pose(chain_of(lines), [0] * 8)[2, 3] - pose(chain_of(XY), [0] * 8)[2, 3]
    assert raised == pytest.approx(100)
    chain = chain_of(lines, conventions={"kin210_base_offset": "mcs_seen_from_carrier"})
    assert pose(chain, [0] * 8)[2, 3] - pose(chain_of(XY), [0] * 8)[2, 3] == pytest.approx(-100)
    assert codes(chain) == []  # decided: no warning
    assert codes(chain_of(XY)) == []


ANGLES = (20.0, -35.0, 50.0)
BASE_ANGLES = [f"trafo[{{}}].base[{k + 3}] {angle * 1e4}" for k, angle in enumerate(ANGLES)]
TURNS = {"A": rotation((1, 0, 0), 20), "B": rotation((0, 1, 0), -35), "C": rotation((0, 0, 1), 50)}


def product(sequence: str) -> np.ndarray:
    T = np.eye(4)
    for letter in sequence:
        T = T @ TURNS[letter]
    return T


def test_base_angles_of_a_robot_follow_the_channel() -> None:
    angles = [line.format(0) for line in BASE_ANGLES]
    ypr = TURNS["C"] @ rotation((0, 1, 0), 35) @ TURNS["A"]
    for mode, R in ((0, ypr), (3, product("CAB")), (4, product("CBA")), (5, product("ABC"))):
        chain = chain_of([*XY, *angles, f"ori_rotation_angle {mode}"])
        expected = np.linalg.inv(R) @ robot_pose([0] * 6)
        assert pose(chain, [0] * 8) == pytest.approx(expected, abs=1e-9)
    chain = chain_of([*XY, *angles], conventions={"kin210_base_rotation": "c_b_a"})
    assert pose(chain, [0] * 8) == pytest.approx(np.linalg.inv(product("CBA")) @ robot_pose([0] * 6), abs=1e-9)


def test_base_angles_of_other_partials_follow_their_axes() -> None:
    group = ["trafo[2].id 210", "trafo[2].group[0].chain[0] HEAD"]
    head = [*CA_HEAD.lines(0, name="HEAD"), *group, *(line.format(0) for line in BASE_ANGLES)]
    expected = np.linalg.inv(product("CAB")) @ shift((0, 0, -250))  # rotary axes C, A
    assert pose(chain_of(head), [0] * 5) == pytest.approx(expected, abs=1e-9)
    nine = ["trafo[0].id 9", "trafo[0].name HEAD", *group, *(line.format(0) for line in BASE_ANGLES)]
    assert pose(chain_of(nine), [0] * 5) == pytest.approx(np.linalg.inv(product("CAB")), abs=1e-9)
    table = [*TABLE.lines(0, name="HEAD"), *group, *(line.format(0) for line in BASE_ANGLES)]
    assert pose(chain_of(table), [0] * 2) == pytest.approx(np.linalg.inv(product("CAB")), abs=1e-9)  # chain: C, A


def test_members_by_id() -> None:
    # P-CHAN-00449 as of build V3.1.3080.09.
    lines = [
        "trafo[0].id 1", "trafo[0].type 210", "trafo[0].group[0].id 100 (comment", "trafo[0].group[0].chain[0] 3 first",
        "trafo[0].group[0].chain[1] 2", "trafo[0].group[0].move_prio[0] 2", "trafo[0].group[0].move_prio[1] 3",
        "trafo[0].group[0].workpiece_cs 200", "trafo[0].group[1].id 200", "trafo[0].group[1].chain[0] 4",
        *(line.replace("id 45", "id 2\ntrafo[1].type 45") for line in robot_lines(1, name="")[:1]),
        *robot_lines(1, name="")[2:],
        *(line.replace("trafo[2].id 91", "trafo[2].id 3\ntrafo[2].type 91") for line in XY_UNIT.lines(2)),
        *(line.replace("trafo[3].id 91", "trafo[3].id 4\ntrafo[3].type 91") for line in TABLE.lines(3)),
    ]  # fmt: skip
    chain = chain_of(lines)
    axes = random_axes(10, np.random.default_rng(5))
    assert pose(chain, axes) == pytest.approx(pose(chain_of(AT_TABLE), axes), abs=1e-9)
    assert [partial.rank for partial in chain.partials] == [1, 0, 0]
    assert codes(chain) == []


def test_the_other_group_may_follow_the_first() -> None:
    # P-CHAN-00448: the table is group 0, whose TCP it is; the robot follows.
    lines = [
        *XY[: -len(XY_GROUP)], *TABLE.lines(3, name="TABLE"), "trafo[2].id 210", "trafo[2].group[0].name CA_TABLE",
        "trafo[2].group[0].chain[0] TABLE", "trafo[2].group[1].name ROBOT", "trafo[2].group[1].workpiece_cs CA_TABLE",
        "trafo[2].group[1].chain[0] LINEAR", "trafo[2].group[1].chain[1] ROBOT",
    ]  # fmt: skip
    chain = chain_of(lines)
    assert codes(chain) == ["CB458", "CB464"]  # C before A, no angle mode given
    axes = random_axes(10, np.random.default_rng(6))
    table = rotation((1, 0, 0), axes[0]) @ rotation((0, 0, 1), axes[1])
    assert pose(chain, axes) == pytest.approx(table, abs=1e-9)
    tip = frame_placement(chain, "ROBOT_tool", axes)
    assert tip[:3, 3] * 1000 == pytest.approx((XY_UNIT.product(axes[2:4]) @ robot_pose(axes[4:]))[:3, 3], abs=1e-9)


def test_groups_without_cooperation_stand_beside_each_other() -> None:
    lines = [line for line in AT_TABLE if "workpiece_cs" not in line]
    chain = chain_of(lines)
    axes = random_axes(10, np.random.default_rng(7))
    assert pose(chain, axes) == pytest.approx(XY_UNIT.product(axes[:2]) @ robot_pose(axes[2:8]), abs=1e-9)
    assert codes(chain) == []


def test_zero_orientation_aims_the_next_base() -> None:
    lines = [line.replace("trafo[1].zero_orientation[2] 1.0", "trafo[1].zero_orientation[2] -1.0") for line in XY]
    axes = random_axes(8, np.random.default_rng(8))
    expected = XY_UNIT.product(axes[:2]) @ rotation((1, 0, 0), 180) @ robot_pose(axes[2:])
    assert pose(chain_of(lines), axes) == pytest.approx(expected, abs=1e-9)


def with_tool(lines: Sequence[str], *tool: str) -> np.ndarray:
    found = machine("\n".join([*lines, *tool]), overlay=Overlay(tool={"number": 1.0}))
    return pose(found.chain(), [0] * 8)


def test_the_tool_sits_on_one_partial() -> None:
    plain = pose(chain_of(XY), [0] * 8)
    # Without a name: on the last partial of the first group; HD34 = 4 lets its length act along z.
    lines = [*XY, "trafo[0].param[33] 4"]
    assert np.linalg.inv(plain) @ with_tool(lines, "wz[1].laenge 500000") == pytest.approx(shift((0, 0, 50)), abs=1e-9)
    assert pose(chain_of(lines, tool_length_mm=50.0), [0] * 8) == pytest.approx(with_tool(lines, "wz[1].laenge 500000"))
    named = with_tool(lines, "wz[1].kin_name ROBOT", "wz[1].kinematic.param[0] 100000")
    assert np.linalg.inv(plain) @ named == pytest.approx(shift((0, 0, 10)), abs=1e-9)
    # On the linear unit the tool's parameters are those of the unit: slot 4 is zero_position[1].
    below = with_tool(lines, "wz[1].kin_name LINEAR", "wz[1].kinematic.param[4] 100000", "wz[1].laenge 70000")
    assert below @ np.linalg.inv(plain) == pytest.approx(shift((0, 10, -7)), abs=1e-9)


def test_limits_are_those_of_the_axes_behind_the_tcp() -> None:
    names = ["XT", "YT", "ZT", "AT", "BT", "CT", "XL", "YL", "R1", "R2", "R3", "R4", "R5", "R6"]
    lines = [*XY, *(f"gruppe[0].achse[{n}].bezeichnung {name}" for n, name in enumerate(names))]
    found = machine("\n".join(lines), overlay=Overlay(limits={"X": (-1.0, 2.0), "A2": (-3.0, 4.0)}))
    axes = {axis.name: (axis.lower, axis.upper) for axis in found.chain().axes}
    assert axes["XL"] == (-1, 2)
    assert axes["R6"] == (-3, 4)
    alone = found.chain("ROBOT")
    assert [axis.lower for axis in alone.axes] == [-360] * 5 + [-3]
    assert [axis.name for axis in alone.axes] == names[8:]
    assert [axis.name for axis in found.chain("LINEAR").axes] == ["XL", "YL"]
    with pytest.raises(ChainbuildError, match="no axis 'Q'"):
        machine("\n".join(XY), overlay=Overlay(limits={"Q": (0.0, 1.0)})).chain()


def test_a_partial_alone_may_have_fewer_axes() -> None:
    assert [axis.name for axis in chain_of(XY, kinematic="LINEAR").axes] == ["X", "Y"]
    assert codes(chain_of(XY, kinematic="LINEAR")) == []
    alone = chain_of(XY_UNIT.lines(1, name="LINEAR"), kinematic="LINEAR")
    assert [finding.text for finding in alone.findings] == [
        "a universal kinematic of two axes is described as a partial of a coupling only"
    ]


def test_locked_freedoms() -> None:
    lines = [*XY, "trafo[2].lock_dof[7] 1", "trafo[2].lock_dof[8] 0", "trafo[2].lock_dof[11] 1"]
    assert [partial.locked for partial in chain_of(lines).partials] == [("Y",), ("A",)]
    with pytest.raises(ChainbuildError, match=r"lock_dof\[14\] is not an axis of a partial") as caught:
        chain_of([*XY, "trafo[2].lock_dof[14] 1"])
    assert caught.value.permitted == "6 to 13"


def test_unknown_entries_leave_a_finding() -> None:
    assert codes(chain_of([*XY, "trafo[2].group[0].chian[1] ROBOT", "trafo[2].lock_dofs[1] 1"])) == ["CB456", "CB456"]


def test_the_legacy_form() -> None:
    lines = [line.replace("trafo[2].", "kinematik[210].") for line in XY if line != "trafo[2].id 210"]
    axes = random_axes(8, np.random.default_rng(10))
    assert pose(chain_of(lines, kinematic=210), axes) == pytest.approx(pose(chain_of(XY), axes))


def test_slips_of_the_manual_are_read() -> None:
    # 3.5 prints chain[1] for the only member, 3.2.1 'Robot' for ROBOT.
    lines = [line.replace("group[0].chain[0] LINEAR", "group[0].chain[0] Linear") for line in AT_TABLE]
    lines = [line.replace("group[1].chain[0]", "group[1].chain[1]") for line in lines]
    chain = chain_of(lines)
    assert codes(chain) == ["CB456", "CB456"]
    axes = random_axes(10, np.random.default_rng(9))
    assert pose(chain, axes) == pytest.approx(pose(chain_of(AT_TABLE), axes))


def test_the_permitted_partials() -> None:
    assert set(coupling_data()["partials"]) == {"5", "6", "7", "8", "9", "10", "45", "91", "96", "213"}
    for kin in (5, 6, 7, 8, 9, 10, 45, 96, 213):
        lines = [f"trafo[0].id {kin}", "trafo[0].name P", "trafo[1].id 210", "trafo[1].group[0].chain[0] P"]
        chain = chain_of(lines)
        assert chain.kinematic == f"KIN_TYP 210 ({kin})"
        own = chain_of(lines, kinematic=kin)
        axes = np.array([20.0 * n for n in range(len(own.axes))])
        assert pose(chain, axes) == pytest.approx(pose(own, axes), abs=1e-9)


@pytest.mark.parametrize(
    "name", ["robot_xy_unit_kin210", "robot_tilting_table_kin210", "gantry_robot_kin210", "robot_head_kin210"]
)
def test_shipped_couplings(name: str) -> None:
    loaded = chainbuild.load(name)
    assert [entry.type for entry in loaded.kinematics() if entry.default] == ["KIN_TYP 210"]
    chain = loaded.chain()
    assert set(codes(chain)) <= {"CB454"}
    assert not any(axis.assumed or axis.max_speed is None for axis in chain.axes)
    robot = chainbuild.Robot(chain)
    lower = np.array([axis.lower for axis in chain.axes])
    upper = np.array([axis.upper for axis in chain.axes])
    rng = np.random.default_rng(11)
    for _ in range(200):
        T = robot.fk(lower + (upper - lower) * rng.random(len(lower)))
        found = robot.ik(T)
        assert found.success
        assert np.abs(robot.fk(found.axes).homogeneous - T.homogeneous).max() < 2e-6
        assert robot.violated_limits(found.axes) == ()


def test_fifteen_axes() -> None:
    lines = [
        *CA_HEAD.lines(0, name="GANTRY"), *robot_lines(1), "trafo[2].id 5", "trafo[2].name HEAD",
        "trafo[3].id 210", "trafo[3].group[0].chain[0] GANTRY", "trafo[3].group[0].chain[1] ROBOT",
        "trafo[3].group[0].chain[2] HEAD",
    ]  # fmt: skip
    chain = chain_of(lines)
    assert len(chain.axes) == 15
    robot = chainbuild.Robot(chain)
    rng = np.random.default_rng(12)
    for _ in range(100):
        axes = rng.uniform(-150, 150, 15)
        T = robot.fk(axes)
        found = robot.ik(T)
        assert found.success
        assert np.abs(robot.fk(found.axes).homogeneous - T.homogeneous).max() < 2e-6


@pytest.mark.parametrize("members", [["ROBOT"], ["LINEAR", "ROBOT"]])
def test_the_tool_frame_of_a_following_group_is_that_of_its_last_member(members: list[str]) -> None:
    lines = [
        *XY[: -len(XY_GROUP)], *TABLE.lines(3, name="TABLE"), "trafo[2].id 210", "trafo[2].group[0].name CA_TABLE",
        "trafo[2].group[0].chain[0] TABLE", "trafo[2].group[1].name ROBOT", "trafo[2].group[1].workpiece_cs CA_TABLE",
        *(f"trafo[2].group[1].chain[{n}] {member}" for n, member in enumerate(members)),
    ]  # fmt: skip
    chain = chain_of(lines)
    (told,) = (finding for finding in chain.findings if finding.code == "CB458")
    assert told.hint == "its own tool frame is ROBOT_tool"
    assert "ROBOT_tool" in {frame.name for frame in chain.frames}
