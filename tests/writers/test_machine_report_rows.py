"""Denavit-Hartenberg rows and screws of a report: the numbers printed, multiplied out here, give the poses."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import chainbuild
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Frame
from chainbuild.frames import rot_about, transform
from chainbuild.robot import Robot
from chainbuild.writers.machine_report.document.blocks import Chapter, Heading, Paragraph, TableBlock
from chainbuild.writers.machine_report.rows import rows_chapters

COUNT = 100  # positions of a machine
LOOPS = {"delta_kin37", "lambda_kin21", "rod_table_kin19", "tripod_kin12", "tripod_table_kin209"}
SERIAL = [name for name in chainbuild.shipped() if name not in LOOPS]


def turn(axis: int, degrees: np.ndarray) -> np.ndarray:
    """Return turns (n, 4, 4) about a coordinate axis."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    T = np.tile(np.eye(4), (len(degrees), 1, 1))
    i, j = [n for n in range(3) if n != axis]
    sign = -1.0 if axis == 1 else 1.0
    T[:, i, i], T[:, j, j], T[:, i, j], T[:, j, i] = c, c, -sign * s, sign * s
    return T


def shift(axis: int, lengths: np.ndarray) -> np.ndarray:
    """Return shifts (n, 4, 4) along a coordinate axis."""
    T = np.tile(np.eye(4), (len(lengths), 1, 1))
    T[:, axis, 3] = lengths
    return T


def values_of(robot: Robot, axes: np.ndarray) -> dict[str, np.ndarray]:
    """Return what the names in a table stand for: axis values, and joint values in mm and degrees."""
    found = {axis.name: axes[:, n] for n, axis in enumerate(robot.axes)}
    if not isinstance(robot.chain.axis_map, AffineMap):
        q = np.array([robot.q(row) for row in axes])
        for n, joint in enumerate(robot.chain.joints):
            found[f"q[{joint.name}]"] = np.degrees(q[:, n]) if joint.kind == "revolute" else 1000.0 * q[:, n]
    return found


def value(text: str, names: dict[str, np.ndarray]) -> np.ndarray:
    """Return a cell such as "-A2 - A3 + 90" as values (n,)."""
    total = np.zeros(len(next(iter(names.values()))))
    for sign, term in re.findall(r"(^-?| [+-] )([^ ]+)", text):
        factor, _, name = term.rpartition("*")
        size = float(factor or 1.0) * (names[name] if name in names else float(name))
        total = total + (-size if "-" in sign else size)
    return total


def tables(chapter: Chapter) -> dict[str, TableBlock]:
    found, title = {}, ""
    for block in chapter.blocks:
        if isinstance(block, Heading):
            title = "".join(block.parts)
        elif isinstance(block, TableBlock):
            found[title] = block
    return found


def from_rows(table: TableBlock, names: dict[str, np.ndarray]) -> np.ndarray:
    """Return the product (n, 4, 4) of Denavit-Hartenberg rows in the order of the columns of the table, mm."""
    steps = {
        "θ [deg]": lambda x: turn(2, x), "d [mm]": lambda x: shift(2, x),
        "a [mm]": lambda x: shift(0, x), "α [deg]": lambda x: turn(0, x),
    }  # fmt: skip
    T = np.tile(np.eye(4), (COUNT, 1, 1))
    for row in table.rows:
        for title, cell in zip(table.head[1:], row[1:], strict=True):
            T = T @ steps[title](value(cell, names))
    return T


def from_screws(screws: TableBlock, M: TableBlock, names: dict[str, np.ndarray]) -> np.ndarray:
    """Return the product (n, 4, 4) of the exponentials of screws, in closed form, mm."""
    T = np.tile(np.eye(4), (COUNT, 1, 1))
    for _, theta, unit, *parts in screws.rows:
        w, v = np.array(parts[:3], dtype=float), np.array(parts[3:], dtype=float)
        amount = value(theta, names)
        if unit == "deg":
            point = np.cross(w, v)
            R = np.array([rot_about(w, angle) for angle in amount])
            step = np.tile(np.eye(4), (COUNT, 1, 1))
            step[:, :3, :3], step[:, :3, 3] = R, point - R @ point
        else:
            step = np.array([transform(None, v * length) for length in amount])
        T = T @ step
    last = np.vstack([np.array(M.rows, dtype=float), [0.0, 0.0, 0.0, 1.0]])
    return T @ last


def workpiece_said(chapter: Chapter) -> np.ndarray:
    """Return the workpiece frame in the base that a chapter tells where nothing moves it, mm."""
    text = next(b.parts[0] for b in chapter.blocks if isinstance(b, Paragraph) and "programmed pose" in b.parts[0])
    found = re.search(r"\(4 × 4, mm\): (.*)\.$", text)
    return np.eye(4) if found is None else np.array([row.split(", ") for row in found[1].split("; ")], dtype=float)


def check_against_poses(robot: Robot, chapter: Chapter, tips: dict[str, np.ndarray]) -> None:
    """Compare tool in workpiece, from what the tables give, with forward kinematics: 1e-9 m, 1e-9 rad."""
    workpiece = tips.get("workpiece", np.tile(workpiece_said(chapter), (COUNT, 1, 1)))
    T = np.linalg.inv(workpiece) @ tips["tool"]
    T[:, :3, 3] /= 1000.0
    np.testing.assert_allclose(T, robot.fk_batch(positions(robot)), rtol=0.0, atol=1e-9)


def positions(robot: Robot) -> np.ndarray:
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    return np.random.default_rng(5).uniform(lower, upper, (COUNT, len(lower)))


@pytest.mark.parametrize("name", SERIAL)
def test_the_tables_multiplied_out_are_the_poses(name: str) -> None:
    robot = Robot.load(name)
    names = values_of(robot, positions(robot))
    rows, screws = rows_chapters(robot)
    found, twists = tables(rows), tables(screws)
    kept = [tip for tip in ("tool", "workpiece") if f"Base to {tip}, standard" in found]
    assert "tool" in kept
    for how in ("standard", "modified"):
        table = {tip: from_rows(found[f"Base to {tip}, {how}"], names) for tip in kept}
        check_against_poses(robot, rows, table)
    products = {tip: from_screws(twists[f"Base to {tip}: screws"], twists[f"Base to {tip}: M"], names) for tip in kept}
    check_against_poses(robot, screws, products)


def test_the_screws_are_those_of_the_matrix_exponential() -> None:
    robot = Robot.load("irb2600_table")
    axes = positions(robot)[0]
    twists = tables(rows_chapters(robot)[1])
    T = {}
    for tip in ("tool", "workpiece"):
        T[tip] = np.eye(4)
        for _, name, unit, *parts in twists[f"Base to {tip}: screws"].rows:
            (x, y, z), v = np.array(parts[:3], dtype=float), np.array(parts[3:], dtype=float)
            amount = float(axes[[axis.name for axis in robot.axes].index(name)])
            hat = np.zeros((4, 4))
            hat[:3, :3], hat[:3, 3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]], v
            T[tip] = T[tip] @ expm(hat * (np.radians(amount) if unit == "deg" else amount))
        T[tip] = T[tip] @ np.vstack([np.array(twists[f"Base to {tip}: M"].rows, dtype=float), [0, 0, 0, 1]])
    pose = np.linalg.inv(T["workpiece"]) @ T["tool"]
    pose[:3, 3] /= 1000.0
    np.testing.assert_allclose(pose, robot.fk(axes).homogeneous, rtol=0.0, atol=1e-9)


def test_right_angles_that_a_file_rounds_are_right_angles(tmp_path: Path) -> None:
    """URDF files write pi/2 with eleven decimals; a table of a UR5 has no use for what that leaves."""
    half = "1.57079632679"
    steps = [("0 0 0.089159", "0", "0 0 1"), ("0 0.13585 0", half, "0 1 0"), ("0 -0.1197 0.425", "0", "0 1 0")]
    joints = "".join(
        f'<link name="l{n + 1}"/><joint name="j{n + 1}" type="revolute"><parent link="l{n}"/><child link="l{n + 1}"/>'
        f'<origin xyz="{xyz}" rpy="0 {turn} 0"/><axis xyz="{axis}"/>'
        '<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>'
        for n, (xyz, turn, axis) in enumerate(steps)
    )
    tip = (
        '<link name="t"/><joint name="e" type="fixed"><parent link="l3"/><child link="t"/>'
        f'<origin rpy="-{half} 0 0" xyz="0 0.08 0"/></joint>'
    )
    file = tmp_path / "arm.urdf"
    file.write_text(f'<robot name="arm"><link name="l0"/>{joints}{tip}</robot>')
    robot = Robot.from_urdf(file)
    rows, screws = rows_chapters(robot)
    table = tables(rows)["Base to tool, standard"]
    assert [row[1:] for row in table.rows] == [
        ["j1", "89.159", "0", "-90"],
        ["j2", "0", "425", "0"],
        ["j3 + 90", "96.15", "0", "0"],
    ]
    names = values_of(robot, positions(robot))
    check_against_poses(robot, rows, {"tool": from_rows(table, names)})
    twists = tables(screws)
    assert max(len(cell) for row in twists["Base to tool: screws"].rows for cell in row) < 9
    found = from_screws(twists["Base to tool: screws"], twists["Base to tool: M"], names)
    check_against_poses(robot, screws, {"tool": found})


def test_a_known_arm_has_its_textbook_rows() -> None:
    found = tables(rows_chapters(Robot.load("kr6r900"))[0])
    joints = [f"A{n}" for n in range(1, 7)]
    # Rows of base and tip in which all is 0 are left out.
    assert [row[0] for row in found["Base to tool, standard"].rows] == ["base", *joints]
    assert [row[0] for row in found["Base to tool, modified"].rows] == [*joints, "tool"]
    assert found["Base to tool, modified"].rows[:3] == [
        ["A1", "180", "0", "A1", "-400"], ["A2", "90", "25", "A2", "0"], ["A3", "0", "455", "A3 - 90", "0"],
    ]  # fmt: skip


def test_three_slides_turn_the_same_way_from_one_to_the_next() -> None:
    """Of two senses that are a quarter turn off, that of the product of the directions is taken on every processor."""
    found = tables(rows_chapters(Robot.load("ac_table_kin58"))[0])
    assert found["Base to tool, standard"].rows == [
        ["base", "90", "0", "0", "90"], ["X", "90", "X", "0", "90"], ["Y", "90", "Y", "0", "90"],
        ["Z", "0", "Z - 150", "0", "0"],
    ]  # fmt: skip


@pytest.mark.parametrize("name", sorted(LOOPS))
def test_what_hangs_in_loops_has_a_reason_instead(name: str) -> None:
    robot = Robot.load(name)
    for chapter in rows_chapters(robot):
        told = [block.parts[0] for block in chapter.blocks if isinstance(block, Paragraph)]
        assert sum("hangs in closed loops" in text for text in told) == 1
    found = tables(rows_chapters(robot)[0])
    serial = {"tripod_table_kin209": "workpiece", "rod_table_kin19": "tool"}.get(name)
    assert {title.split(",")[0] for title in found} == ({f"Base to {serial}"} if serial else set())


def test_the_serial_side_of_a_machine_with_loops_has_rows() -> None:
    robot = Robot.load("tripod_table_kin209")
    axes = np.tile([800.0, 800.0, 800.0, 20.0, 30.0], (COUNT, 1))
    names = {axis.name: axes[:, n] for n, axis in enumerate(robot.axes)}
    T = from_rows(tables(rows_chapters(robot)[0])["Base to workpiece, standard"], names)[0]
    T[:3, 3] /= 1000.0
    np.testing.assert_allclose(T, robot.frame_placements(axes[0])["workpiece"].homogeneous, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("name", SERIAL)
def test_of_two_senses_of_a_normal_the_one_with_the_smaller_turn_is_taken(name: str) -> None:
    robot = Robot.load(name)
    still = {key: np.zeros(1) for key in values_of(robot, np.zeros((1, len(robot.axes))))}
    for title, table in tables(rows_chapters(robot)[0]).items():
        for _, theta, _, a, alpha in table.rows if title.endswith("standard") else ():
            # Lines that meet at an angle have a normal of either sense.
            if a == "0" and alpha not in ("0", "180"):
                assert abs(value(theta, still)[0]) <= 90.0


def turned_tool(R: np.ndarray) -> Robot:
    """Return an arm whose tool is turned off the last axis and lies beside it."""
    chain = chainbuild.load("kr6r900").chain()
    tool = chain.frame("tool")
    turned = Frame("tool", tool.link, tool.T_link_frame @ transform(R, [0.1, 0.02, 0.05]))
    return Robot(replace(chain, frames=tuple(turned if one is tool else one for one in chain.frames)))


def nearly_parallel(angle_deg: float) -> Robot:
    return turned_tool(rot_about([0.0, 1.0, 0.0], angle_deg))


def test_nearly_parallel_lines_have_a_reason_and_screws() -> None:
    rows, screws = rows_chapters(nearly_parallel(0.001))
    assert any("A6 and the tool's z are 0.001° from parallel" in b.parts[0] for b in rows.blocks if b.parts)
    assert not tables(rows)
    assert "Base to tool: screws" in tables(screws)


@pytest.mark.parametrize("robot", [nearly_parallel(1.0), turned_tool(rot_about([0.3, 0.8, 0.5], 37.0))])
def test_rows_of_skew_lines_give_the_poses(robot: Robot) -> None:
    names = values_of(robot, positions(robot))
    rows, _ = rows_chapters(robot)
    check_against_poses(robot, rows, {"tool": from_rows(tables(rows)["Base to tool, standard"], names)})
