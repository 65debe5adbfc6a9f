"""What must hold for every type whose rotary axes all sit in the tool head."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import MachineDataError
from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.machines import shipped
from tests.kit.compare import assert_jacobian_is_the_derivative
from tests.kit.kin_types import HEADS, axes_inside, build, distance, head_hd
from tests.kit.paths import REFERENCE

# Smallest parameters that make a machine, where all zeros do not.
MINIMAL: dict[int, dict[int | str, float]] = {59: {7: 45.0}, 60: {7: 45.0}, 207: {4: 90.0}, 8: {4: 90.0}, 18: {4: 90.0}}
# Tool vector with all axes at zero, where it is not (0, 0, 1): upper spindle up, cross head and saws level, 6 up.
TOOL_VECTORS = {
    3: (0, 0, -1), 5: (0, -1, 0), 6: (0, 0, -1), 8: (0, -1, 0), 18: (0, -1, 0), 207: (0, -1, 0),
}  # fmt: skip


@pytest.mark.parametrize("kin", HEADS)
def test_tool_vector_at_zero(kin: int) -> None:
    built = build(kin, MINIMAL.get(kin))
    assert built.tool_vector(built.zeros()) == pytest.approx(TOOL_VECTORS.get(kin, (0, 0, 1)), abs=1e-15)


def test_tool_vectors_of_the_drawn_rest_positions() -> None:
    assert build(3).tool_vector([0, 0, 0, 180]) == pytest.approx((0, 0, 1), abs=1e-15)
    assert build(8, {4: 0}).tool_vector([0] * 4) == pytest.approx((0, 0, 1), abs=1e-15)
    assert build(10).tool_vector([0, 0, 0, 0, 90]) == pytest.approx((0, -1, 0), abs=1e-15)


def test_the_two_ways_to_a_direction_of_the_ca_head() -> None:
    for c, a in ((0, 45), (180, -45)):  # KIN_TYP manual 1.4
        assert build(9).tool_vector([0, 0, 0, c, a]) == pytest.approx((0, -math.sqrt(0.5), math.sqrt(0.5)), abs=1e-12)


@pytest.mark.parametrize("kin", HEADS)
def test_rank_is_the_number_of_axes(kin: int) -> None:
    built = build(kin, head_hd(kin), 80.0)
    J = built.robot.jacobian(axes_inside(built.robot, 1)[0])
    virtual = 1 if kin == 70 else 0  # CV has no drive
    assert np.linalg.matrix_rank(J, tol=1e-6) == len(built.robot.axes) - virtual


@pytest.mark.parametrize("kin", HEADS)
def test_jacobian_is_the_derivative(kin: int) -> None:
    built = build(kin, head_hd(kin), 80.0)
    assert_jacobian_is_the_derivative(built.robot, axes_inside(built.robot, 20))


@pytest.mark.parametrize("kin", HEADS)
def test_axis_values_come_back(kin: int) -> None:
    built = build(kin, head_hd(kin), 80.0)
    for axes in axes_inside(built.robot, 20):
        q = built.robot.q(axes)
        back = built.robot.axes_from_q(q)
        assert built.robot.q(back) == pytest.approx(q, abs=1e-12)
        if kin != 70:
            assert back == pytest.approx(axes, abs=1e-9)


@pytest.mark.parametrize("kin", HEADS)
def test_joints_bear_the_names_of_the_axes(kin: int) -> None:
    built = build(kin, head_hd(kin), 80.0)
    helpers = {25: {"nozzle"}, 207: {"plunge"}}.get(kin, set())
    virtual = {"CV"} if kin == 70 else set()
    joints = {joint.name: joint.kind for joint in built.robot.chain.joints}
    assert set(joints) == {axis.name for axis in built.robot.axes} - virtual | helpers
    for axis in built.robot.axes:
        if axis.name in joints:
            assert (axis.kind == "rotary") == (joints[axis.name] == "revolute")


@pytest.mark.parametrize("kin", HEADS)
def test_joint_bounds_hold_what_the_axes_reach(kin: int) -> None:
    built = build(kin, head_hd(kin), 80.0)
    axes = built.robot.axes
    lower, upper = np.array([a.lower for a in axes]), np.array([a.upper for a in axes])
    low, high = built.robot.chain.axis_map.q_bounds(lower, upper)
    rng = np.random.default_rng(3)
    reached = np.array([built.robot.q(lower + (upper - lower) * rng.random(len(axes))) for _ in range(300)])
    assert np.isfinite(low).all() and np.isfinite(high).all()
    assert (reached >= low - 1e-12).all() and (reached <= high + 1e-12).all()
    assert built.robot.q(upper) == pytest.approx(np.clip(built.robot.q(upper), low, high), abs=1e-9)


@pytest.mark.parametrize("kin", HEADS)
def test_the_tool_length_follows_the_tool_vector(kin: int) -> None:
    short, long = build(kin, head_hd(kin)), build(kin, head_hd(kin), 80.0)
    for axes in axes_inside(long.robot, 3):
        expected = -80.0 * short.tool_vector(axes)
        if kin == 33:
            expected = np.zeros(3)  # the head keeps the tip by its mechanics
        if kin == 25:
            expected /= math.cos(math.radians(axes[4] - head_hd(25)[3]))
        moved = long.base_mm("tool", axes) - long.base_mm("flange", axes)
        T_workpiece = long.base_rotation("workpiece", axes)
        if kin != 207:
            assert T_workpiece.T @ moved == pytest.approx(expected, abs=1e-9)
        assert short.base_rotation("tool", axes) == pytest.approx(long.base_rotation("tool", axes), abs=1e-15)


# HD21 decides how C and A are programmed, HD19 and HD20 need a blade or a hand-set cutter: tested on their own.
SWITCHES = {(59, 19), (59, 20), (59, 21), (60, 21)}


@pytest.mark.parametrize(
    ("kin", "n"), [(k, row.n) for k in HEADS for row in type_data()[k].hd if (k, row.n) not in SWITCHES]
)
def test_every_parameter_does_what_its_row_says(kin: int, n: int) -> None:
    row, hd = type_data()[kin].row(n), head_hd(kin)
    if kin == 5:
        hd[5] = 95.0 if n == 3 else 5.0  # HD2 and HD3 belong to different tools
    before = hd.get(n, 0.0)
    changed = {**hd, n: -before if row.kind == "sign" else 1.0 - before if row.kind == "flag" else before + 9.0}
    first, second = build(kin, hd, 80.0), build(kin, changed, 80.0)
    points = axes_inside(first.robot, 5)
    apart = min(distance(first.robot.fk(axes), second.robot.fk(axes)) for axes in points)
    assert (apart > 1e-4) == (row.effect == "pose"), row.name


@pytest.mark.parametrize(
    ("kin", "n", "value"),
    [(16, 9, 2), (16, 10, -3), (22, 4, 2), (22, 5, 0.5), (28, 14, 4), (28, 15, -2), (30, 4, 7), (33, 7, 2), (59, 20, 3),
     (59, 21, 2), (60, 21, -1), (70, 9, 5), (70, 10, 0.1)],
)  # fmt: skip
def test_values_that_are_not_permitted_are_refused(kin: int, n: int, value: float) -> None:
    hd = {**head_hd(kin), n: value}
    with pytest.raises(MachineDataError, match=f"HD{n} is {value:g}"):
        build(kin, hd)
    lenient = build(kin, hd, strict=False)
    assert "CB401" in lenient.codes()
    assert np.isfinite(lenient.mm(lenient.zeros())).all()


@pytest.mark.parametrize("kin", (16, 22, 28, 30, 70))
def test_a_direction_of_zero_counts_as_plus_with_a_finding(kin: int) -> None:
    hd = head_hd(kin)
    signs = [row.n for row in type_data()[kin].hd if row.kind == "sign"]
    absent, plus = ({**hd, **dict.fromkeys(signs, value)} for value in (0.0, 1.0))
    first, second = build(kin, absent), build(kin, plus)
    assert first.codes().count("CB402") == len(signs) and "CB402" not in second.codes()
    axes = axes_inside(first.robot, 1)[0]
    assert distance(first.robot.fk(axes), second.robot.fk(axes)) == 0


@pytest.mark.parametrize(
    ("kin", "name", "hd"),
    [(9, "kin9_nut90_1", {1: 150.0}), (59, "kin59_1", {1: 120.0, 7: 60.0, 21: 1.0})],
)
def test_reference_poses(kin: int, name: str, hd: dict[int | str, float]) -> None:
    reference = json.loads((REFERENCE / f"{name}.json").read_text("utf-8"))
    built = build(kin, hd, reference["tool_length"])
    assert len(reference["rows"]) >= 30
    for row in reference["rows"]:
        assert built.mm(row["axes"]) == pytest.approx(row["p"], abs=1e-8)
        assert built.tool_vector(row["axes"]) == pytest.approx(row["z"], abs=1e-11)


MACHINES = [name for name in shipped() if name.rpartition("_kin")[2] in {str(kin) for kin in HEADS}]


def test_every_family_of_heads_ships_a_machine() -> None:
    kinds = {int(name.rpartition("_kin")[2]) for name in MACHINES}
    assert {9, 25, 28, 7} <= kinds and {10, 207} <= kinds and {4, 5, 6} <= kinds and {16, 70} <= kinds
    assert {11, 76} <= kinds and {59, 60} <= kinds


@pytest.mark.parametrize("name", MACHINES)
def test_shipped_machines_solve_their_own_poses(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    assert not [finding for finding in robot.chain.findings if finding.severity != "info"]
    assert not any(axis.assumed or axis.max_speed is None for axis in robot.axes)
    rng = np.random.default_rng(4)
    for _ in range(5):
        axes = np.array([rng.uniform(axis.lower, axis.upper) for axis in robot.axes])
        target = robot.fk(axes)
        found = robot.ik(target, held={"CV": axes[-1]} if "kin70" in name else None)
        assert found.success and np.abs(robot.fk(found.axes).translation - target.translation).max() < 1e-6
