"""Chains stacked and followed: the pose of the whole is the product of the poses of its parts."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.axismap import AffineMap, BlockMap
from chainbuild.chain.compose import beside, displaced, follow, stack
from chainbuild.chain.elements import Chain, Loop
from chainbuild.chain.names import Names
from chainbuild.chain.poses import angle_rates, frame_placement, pose, pose_jacobian, rotation_vector
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.frames import ANGLE_MODES, matrix_from_angles
from tests.kit.draws import random_axes

# Both dialects; the workpiece on the base, on a rotary table, on slides; affine maps and a nonlinear one.
NAMES = ("kr6r900", "ac_table_kin58", "scara_kin36", "bed_mill_kin1", "cac_table_kin64", "cardan_head_kin59")


@pytest.fixture(scope="module")
def chains() -> dict[str, Chain]:
    return {name: chainbuild.load(name).chain() for name in NAMES}


def random_transform(rng: np.random.Generator) -> np.ndarray:
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    T = np.eye(4)
    T[:3, :3] = Q * np.sign(np.linalg.det(Q))
    T[:3, 3] = rng.normal(size=3)
    return T


def fk(chain: Chain, axes: np.ndarray) -> np.ndarray:
    return chainbuild.Robot(chain).fk(axes).homogeneous


@pytest.mark.parametrize(("a", "b"), list(itertools.product(NAMES, NAMES)))
def test_stacked_poses_multiply(chains: dict[str, Chain], a: str, b: str) -> None:
    rng = np.random.default_rng(1)
    lower, upper, T = chains[a], chains[b], random_transform(rng)
    whole = stack(lower, T, upper)
    n = len(lower.axes)
    for _ in range(5):
        axes = random_axes(whole, rng)
        expected = fk(lower, axes[:n]) @ T @ fk(upper, axes[n:])
        assert np.abs(fk(whole, axes) - expected).max() < 1e-12
        assert np.abs(pose(whole, axes) - expected).max() < 1e-12


@pytest.mark.parametrize(("a", "b"), list(itertools.product(NAMES, NAMES)))
def test_a_followed_chain_counts_from_the_other(chains: dict[str, Chain], a: str, b: str) -> None:
    rng = np.random.default_rng(2)
    chain, other = chains[a], chains[b]
    whole = follow(chain, workpiece_of=other)
    n = len(chain.axes)
    for _ in range(5):
        axes = random_axes(whole, rng)
        expected = np.linalg.inv(fk(other, axes[n:])) @ fk(chain, axes[:n])
        assert np.abs(fk(whole, axes) - expected).max() < 1e-11
    assert [axis.carries for axis in whole.axes[n:]] == ["workpiece"] * len(other.axes)
    assert [partial.group for partial in whole.partials] == [0, 1]


@pytest.mark.parametrize(("a", "b"), [("kr6r900", "ac_table_kin58"), ("bed_mill_kin1", "scara_kin36")])
def test_a_chain_beside_leaves_the_pose_alone(chains: dict[str, Chain], a: str, b: str) -> None:
    rng = np.random.default_rng(3)
    chain, other = chains[a], chains[b]
    whole = beside(chain, other)
    axes = random_axes(whole, rng)
    n = len(chain.axes)
    assert np.abs(fk(whole, axes) - fk(chain, axes[:n])).max() < 1e-12
    # Both count from the workpiece frame of the first.
    tip = np.linalg.inv(frame_placement(whole, "workpiece", axes)) @ frame_placement(whole, f"{b}_tool", axes)
    assert np.abs(tip - fk(other, axes[n:])).max() < 1e-12


def test_a_displaced_chain_counts_from_elsewhere(chains: dict[str, Chain]) -> None:
    rng = np.random.default_rng(4)
    for chain in chains.values():
        T, axes = random_transform(rng), random_axes(chain, rng)
        moved = displaced(chain, T)
        assert np.abs(fk(moved, axes) - T @ fk(chain, axes)).max() < 1e-12
        assert np.array_equal(moved.partials[0].T_carrier_mcs, T)


def test_deep_stacks(chains: dict[str, Chain]) -> None:
    rng = np.random.default_rng(5)
    whole = chains["bed_mill_kin1"]
    parts, offsets = [whole], []
    for name in (*NAMES, *NAMES):
        T = random_transform(rng)
        whole = stack(whole, T, chains[name])
        parts.append(chains[name])
        offsets.append(T)
    axes = random_axes(whole, rng)
    expected, first = np.eye(4), 0
    for part, T in zip(parts, [np.eye(4), *offsets], strict=True):
        expected = expected @ T @ fk(part, axes[first : first + len(part.axes)])
        first += len(part.axes)
    assert np.abs(fk(whole, axes) - expected).max() < 1e-9
    assert len({partial.name for partial in whole.partials}) == len(parts)
    assert [partial.first_axis for partial in whole.partials] == np.cumsum([0, *(len(p.axes) for p in parts)])[
        :-1
    ].tolist()


def test_a_stack_may_be_carried(chains: dict[str, Chain]) -> None:
    rng = np.random.default_rng(6)
    inner, outer = random_transform(rng), random_transform(rng)
    upper = follow(stack(chains["kr6r900"], inner, chains["ac_table_kin58"]), workpiece_of=chains["cac_table_kin64"])
    whole = stack(chains["scara_kin36"], outer, upper)
    axes = random_axes(whole, rng)
    assert np.abs(fk(whole, axes) - fk(chains["scara_kin36"], axes[:4]) @ outer @ fk(upper, axes[4:])).max() < 1e-12


def test_names_change_only_where_they_clash(chains: dict[str, Chain]) -> None:
    mill, arm = chains["ac_table_kin58"], chains["kr6r900"]
    both = stack(mill, np.eye(4), arm, lower_name="MILL", upper_name="ARM")
    assert [axis.name for axis in both.axes] == ["X", "Y", "Z", "A", "C", "A1", "A2", "A3", "A4", "A5", "A6"]
    assert {"MILL_tool", "MILL_flange", "ARM_base"} <= {frame.name for frame in both.frames}
    twice = stack(arm, np.eye(4), arm, upper_name="second arm")
    assert [axis.name for axis in twice.axes[6:]] == [f"second_arm_A{n}" for n in range(1, 7)]
    assert [partial.name for partial in twice.partials] == ["kr6r900", "second_arm"]


def test_prefixed_names_avoid_the_guest_s_own(chains: dict[str, Chain]) -> None:
    axes = tuple(replace(axis, name=name) for axis, name in zip(chains["scara_kin36"].axes, "ABCD", strict=True))
    guest = chains["scara_kin36"].with_axes((*axes[:3], replace(axes[3], name="up_A")))
    host = chains["scara_kin36"].with_axes(axes)
    assert list(Names.of(host, guest, "up", "base", "base").axes.values()) == ["up_A_2", "up_B", "up_C", "up_A"]


def test_affine_maps_stay_affine(chains: dict[str, Chain]) -> None:
    rng = np.random.default_rng(7)
    affine = stack(chains["kr6r900"], np.eye(4), chains["bed_mill_kin1"])
    assert isinstance(affine.axis_map, AffineMap)
    mixed = stack(chains["kr6r900"], np.eye(4), chains["cardan_head_kin59"])
    plain = follow(chains["bed_mill_kin1"], workpiece_of=chains["cac_table_kin64"])
    for chain in (affine, mixed, plain):
        axes = random_axes(chain, rng)
        q = chain.axis_map.q(axes)
        assert chain.axis_map.axes(q) == pytest.approx(axes, abs=1e-8)
        lower, upper = chain.axis_map.q_bounds(
            np.array([axis.lower for axis in chain.axes]), np.array([axis.upper for axis in chain.axes])
        )
        assert (q >= lower - 1e-12).all()
        assert (q <= upper + 1e-12).all()


def test_a_block_map_is_its_parts(chains: dict[str, Chain]) -> None:
    rng = np.random.default_rng(8)
    head = chains["cardan_head_kin59"]
    mixed = stack(head, np.eye(4), head)
    assert not isinstance(head.axis_map, AffineMap)
    assert isinstance(mixed.axis_map, BlockMap)
    axes = random_axes(mixed, rng)
    n = len(head.axes)
    assert mixed.axis_map.dq_daxes(axes)[:n, n:] == pytest.approx(0.0)
    assert mixed.axis_map.dq_daxes(axes)[n:, n:] == pytest.approx(head.axis_map.dq_daxes(axes[n:]))


def test_jacobians_agree_with_pinocchio(chains: dict[str, Chain]) -> None:
    rng = np.random.default_rng(9)
    for chain in (*chains.values(), follow(chains["bed_mill_kin1"], workpiece_of=chains["cardan_head_kin59"])):
        axes = random_axes(chain, rng)
        R, J = fk(chain, axes)[:3, :3], chainbuild.Robot(chain).jacobian(axes)
        assert np.abs(np.vstack([R @ J[:3], R @ J[3:]]) - pose_jacobian(chain, axes)).max() < 1e-10


def test_what_is_known_of_the_parts_is_carried_over(chains: dict[str, Chain]) -> None:
    arm = replace(
        chains["scara_kin36"],
        constraints=(AxisConstraint("sum", AxisSum((1.0, 1.0, 0.0, 0.0), 5.0), -90.0, 90.0),),
        absolute_c=AxisSum((1.0, 1.0, 0.0, 1.0), 0.0),
        loops=(Loop("loop", "ball", "flange", "tool"),),
    )
    mill = chains["cac_table_kin64"]
    whole = stack(arm, np.eye(4), arm, upper_name="top")
    assert [c.sum.coefficients for c in whole.constraints] == [(1, 1, 0, 0, 0, 0, 0, 0), (0, 0, 0, 0, 1, 1, 0, 0)]
    assert [(loop.name, loop.frame_a, loop.frame_b) for loop in whole.loops] == [
        ("loop", "flange", "tool"),
        ("top_loop", "flange", "tool"),
    ]
    assert whole.absolute_c is None  # the lower arm turns the upper one
    assert beside(arm, mill).absolute_c == AxisSum((1, 1, 0, 1, *(0,) * 6), 0.0)
    assert follow(arm, workpiece_of=mill).absolute_c is None
    slides = chainbuild.load("gantry_robot_kin210").chain("GANTRY")
    assert stack(slides, np.eye(4), arm).absolute_c == AxisSum((0, 0, 0, 1, 1, 0, 1), 0.0)
    names = {used.convention.name for used in (*arm.conventions, *mill.conventions)}
    assert {used.convention.name for used in stack(mill, np.eye(4), arm).conventions} == names
    held = mill.with_axes(tuple(replace(axis, held=axis.name == "X") for axis in mill.axes))
    assert [axis.held for axis in stack(held, np.eye(4), arm).axes] == [True, *(False,) * 9]


def test_limits_reach_the_partials(chains: dict[str, Chain]) -> None:
    whole = stack(chains["kr6r900"], np.eye(4), chains["kr6r900"], upper_name="top")
    axes = tuple(replace(axis, lower=-float(n), upper=float(n + 1)) for n, axis in enumerate(whole.axes))
    limited = whole.with_axes(axes)
    assert [axis.upper for axis in limited.partials[1].chain.axes] == [7, 8, 9, 10, 11, 12]
    assert [axis.name for axis in limited.partials[1].chain.axes] == ["A1", "A2", "A3", "A4", "A5", "A6"]


def test_composed_robots_are_written_and_solved(chains: dict[str, Chain], tmp_path: object) -> None:
    rng = np.random.default_rng(10)
    whole = follow(stack(chains["ac_table_kin58"], np.eye(4), chains["kr6r900"]), workpiece_of=chains["scara_kin36"])
    robot = chainbuild.Robot(whole)
    assert chainbuild.write_urdf(robot, tmp_path).is_file()  # type: ignore[arg-type]
    axes = random_axes(whole, rng)
    result = robot.ik(robot.fk(axes), start=axes)
    assert result.success


@pytest.mark.parametrize("mode", list(ANGLE_MODES))
def test_angle_rates_are_derivatives(mode: str) -> None:
    angles, step = np.array([20.0, -35.0, 70.0]), 1e-5
    rates = angle_rates(mode, angles.tolist())
    for n in range(3):
        ahead, behind = angles.copy(), angles.copy()
        ahead[n] += step
        behind[n] -= step
        turn = matrix_from_angles(mode, ahead.tolist()) @ matrix_from_angles(mode, behind.tolist()).T
        assert rotation_vector(turn) / np.radians(2 * step) == pytest.approx(rates[:, n], abs=1e-8)


@pytest.mark.parametrize(
    "offset", [np.full((4, 4), np.nan), 3.0 * np.eye(4), np.eye(3), "here", np.diag([1, 1, -1, 1])]
)
def test_what_carries_is_placed_by_a_rigid_transform(offset: object) -> None:
    arm = chainbuild.load("kr6r900").chain()
    with pytest.raises(chainbuild.ChainbuildError, match="T_offset is no rigid 4×4 transform"):
        stack(arm, offset, arm)
