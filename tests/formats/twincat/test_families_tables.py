"""What must hold for every type of the table, mixed, face, lever and arm families."""

from __future__ import annotations

import json

import numpy as np
import pytest

from chainbuild.errors import ChainbuildError, MachineDataError, UnsupportedKinematicError
from chainbuild.formats.twincat.lists.hdtable import type_data
from tests.kit.compare import assert_jacobian_is_the_derivative
from tests.kit.kin_types import axes_anywhere, build, distance, generic_hd
from tests.kit.paths import REFERENCE

TABLES = (1, 13, 14, 23, 34, 52, 57, 58, 61, 63, 64, 80, 81, 82, 202, 203, 205)
ARMS = (36, 85, 96, 206, 208, 213)
TYPES = (*TABLES, *ARMS)

# Tool vector at zero of every axis and parameter, where it is not (0, 0, 1).
TOOL_VECTORS = {202: (1.0, 0.0, 0.0)}


@pytest.mark.parametrize("kin", TYPES)
def test_tool_vector_at_zero(kin: int) -> None:
    built = build(kin)
    assert built.tool_vector(built.zeros()) == pytest.approx(TOOL_VECTORS.get(kin, (0.0, 0.0, 1.0)), abs=1e-15)


def test_tool_vector_at_zero_of_the_variants() -> None:
    assert build(202, {10: 1}).tool_vector([0, 0, 0, 0]) == pytest.approx((-1, 0, 0), abs=1e-15)
    assert build(205, {16: 1}).tool_vector([0, 0, 0]) == pytest.approx((0, 0, 1), abs=1e-15)
    assert build(205, {17: 1}).tool_vector([0, 0, 0]) == pytest.approx((1, 0, 0), abs=1e-15)
    assert build(205, {17: 1}, kin205_x_variant="tool_along_z").tool_vector([0, 0, 0]) == pytest.approx((0, 0, 1))


@pytest.mark.parametrize("kin", TYPES)
def test_rank_is_the_number_of_axes(kin: int) -> None:
    robot = build(kin, generic_hd(type_data()[kin]), 80.0).robot
    J = robot.jacobian(axes_anywhere(robot, 1)[0])
    assert np.linalg.matrix_rank(J, tol=1e-6) == len(robot.axes) == len(type_data()[kin].axes)


@pytest.mark.parametrize("kin", TYPES)
def test_jacobian_is_the_derivative(kin: int) -> None:
    robot = build(kin, generic_hd(type_data()[kin]), 80.0).robot
    assert_jacobian_is_the_derivative(robot, axes_anywhere(robot, 20))


@pytest.mark.parametrize("kin", TYPES)
def test_axis_values_come_back(kin: int) -> None:
    robot = build(kin, generic_hd(type_data()[kin])).robot
    for axes in axes_anywhere(robot, 20):
        assert robot.axes_from_q(robot.q(axes)) == pytest.approx(axes, abs=1e-9)


@pytest.mark.parametrize("kin", TYPES)
def test_joints_bear_the_names_of_the_axes(kin: int) -> None:
    robot = build(kin).robot
    joints = [joint.name for joint in robot.chain.joints]
    axes = [axis.name for axis in robot.axes]
    helpers = {"level"} if kin == 96 else set()
    assert set(joints) == set(axes) | helpers
    for joint in robot.chain.joints:
        for axis in robot.axes:
            if axis.name == joint.name:
                assert (axis.kind == "rotary") == (joint.kind == "revolute")


@pytest.mark.parametrize("kin", TYPES)
def test_what_an_axis_carries_is_what_it_moves(kin: int) -> None:
    built = build(kin, generic_hd(type_data()[kin]))
    start = axes_anywhere(built.robot, 1)[0]
    for n, axis in enumerate(built.robot.axes):
        moved = start + np.eye(len(start))[n] * 7.0
        for frame in ("flange", "workpiece"):
            before, after = (built.robot.frame_placements(axes)[frame] for axes in (start, moved))
            carries = {"flange": "tool", "workpiece": "workpiece"}[frame]
            assert (distance(before, after) > 1e-6) == (axis.carries == carries)


def _other_value(kind: str, value: float) -> float:
    if kind in {"length", "angle"}:
        return value + 11.0
    return 1.0 - value if kind == "flag" else -value


@pytest.mark.parametrize("kin", TYPES)
def test_every_parameter_does_what_its_row_says(kin: int) -> None:
    data = type_data()[kin]
    hd = generic_hd(data)
    robot = build(kin, hd, 80.0).robot
    points = axes_anywhere(robot, 5)
    for row in data.hd:
        changed = {**hd, row.n: 7.0 if row.kind == "count" else _other_value(row.kind, hd.get(row.n, 0.0))}
        if (kin, row.name) == (205, "turns_about_z"):
            changed[17] = 0.0  # both at 1 is refused
        other = build(kin, changed, 80.0).robot
        apart = min(distance(robot.fk(axes), other.fk(axes)) for axes in points)
        assert (apart > 1e-4) == (row.effect == "pose"), row.name


@pytest.mark.parametrize("kin", TYPES)
def test_the_tool_length_moves_the_tip_along_the_tool_vector(kin: int) -> None:
    hd = generic_hd(type_data()[kin])
    short, long = build(kin, hd), build(kin, hd, 80.0)
    for axes in axes_anywhere(short.robot, 3):
        moved = long.mm(axes) - short.mm(axes)
        assert short.robot.frame_placements(axes)["flange"] == long.robot.frame_placements(axes)["flange"]
        if kin == 85:
            assert moved == pytest.approx((0, 0, 0), abs=1e-12)
        elif kin in {206, 208}:
            # Along y or z of the frame that HD4 to HD6 turn the tool against.
            flange = short.robot.frame_placements(axes)["flange"].rotation
            assert moved == pytest.approx(80.0 * flange[:, 1 if kin == 206 else 2], abs=1e-9)
        else:
            assert moved == pytest.approx(-80.0 * short.tool_vector(axes), abs=1e-9)


@pytest.mark.parametrize("kin", TYPES)
def test_flags_refuse_what_the_table_does_not_permit(kin: int) -> None:
    decoded = {57, 58, 61, 63, 64, 80, 81, 82}  # the manual prints no coding: decoded by a convention
    for row in type_data()[kin].hd:
        if row.kind != "flag" or (kin in decoded and row.name.startswith("direction_")):
            continue
        with pytest.raises(MachineDataError, match=rf"HD{row.n} is 2"):
            build(kin, {row.n: 2})
        lenient = build(kin, {row.n: 2}, strict=False)
        assert "CB401" in lenient.codes()
        assert np.isfinite(lenient.mm(lenient.zeros())).all()


@pytest.mark.parametrize("kin", [23, 52])
def test_signs_refuse_what_the_table_does_not_permit(kin: int) -> None:
    with pytest.raises(MachineDataError, match="HD4 is 3"):
        build(kin, {4: 3})
    assert "CB401" in build(kin, {4: 3}, strict=False).codes()


@pytest.mark.parametrize("kin", [23, 52])
def test_a_sign_of_zero_counts_as_plus_with_a_finding(kin: int) -> None:
    given, zero = build(kin, {4: 1, 5: 1}), build(kin, {4: 0, 5: 0})
    assert given.codes() == []
    assert zero.codes() == ["CB402", "CB402"]
    axes = axes_anywhere(given.robot, 1)[0]
    assert distance(given.robot.fk(axes), zero.robot.fk(axes)) == 0.0


def test_a_flag_that_is_none_leaves_a_finding() -> None:
    built = build(58, {12: 5})
    assert built.codes() == ["CB430"]
    assert "HD12 of A is 5; it is read as -1" in str(built.collector.findings[0])
    assert "a length at the wrong index?" in str(built.collector.findings[0])


@pytest.mark.parametrize("name", ["kin58_trt_2", "kin58_trt_3", "kin36_1"])
def test_reference_poses(name: str) -> None:
    data = json.loads((REFERENCE / f"{name}.json").read_text("utf-8"))
    hd: dict[int | str, float] = {}
    for line in (REFERENCE / f"{name}.lis").read_text("utf-8").splitlines():
        if ".param[" in line:
            key, value = line.split()
            hd[int(key.split("[")[2].rstrip("]")) + 1] = float(value) / 10_000.0
    built = build(data["kin"], hd, data["tool_length"])
    assert len(data["rows"]) > 20
    for row in data["rows"]:
        assert built.mm(row["axes"]) == pytest.approx(row["p"], abs=1e-6)
        if "z" in row:
            assert built.tool_vector(row["axes"]) == pytest.approx(row["z"], abs=1e-9)
        if "R" in row:
            assert built.robot.fk(row["axes"]).rotation == pytest.approx(np.array(row["R"]), abs=1e-9)


def test_98_is_refused_by_name() -> None:
    with pytest.raises(UnsupportedKinematicError, match=r"KIN_TYP 98.*neither its axes nor its chain"):
        build(98, kin98_carrier="refused")
    assert issubclass(UnsupportedKinematicError, ChainbuildError)
