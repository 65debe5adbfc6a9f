"""Closed loops in Pinocchio: gaps, freedoms, the elimination against differences, and the parallelogram as a loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild import Loop, Robot
from chainbuild.chain.bodies.geometry import RodData
from chainbuild.chain.bodies.rods import CRANK, ROD, ROD_END, ROD_PIN, with_rods
from chainbuild.errors import ChainbuildError, ChainError
from chainbuild.kinematics.closure import Closure, check_closure, closing_axes, closure_of

MACHINES = ("tripod_kin12", "tripod_table_kin209", "delta_kin37", "lambda_kin21", "rod_table_kin19")


def states(name: str, count: int) -> tuple[Robot, np.ndarray]:
    robot = Robot.load(name)
    rows = closing_axes(robot, np.random.default_rng(4), count)
    assert len(rows) == count
    return robot, rows


@pytest.mark.parametrize("name", MACHINES)
def test_random_states_close_to_rounding_and_leave_one_freedom_an_axis(name: str) -> None:
    robot, rows = states(name, 1000)
    closure = closure_of(robot)
    assert max(closure.gap(robot.q(row)) for row in rows) < 1e-12
    assert {closure.mobility(robot.q(row)) for row in rows[:20]} == {len(robot.axes)}
    check_closure(robot)


@pytest.mark.parametrize("name", MACHINES)
def test_an_open_state_is_polished_back_to_the_closed_form(name: str) -> None:
    robot, rows = states(name, 30)
    closure, rng = closure_of(robot), np.random.default_rng(2)
    passive = np.isin(np.arange(robot.model.nv), closure.passive)
    assert passive.sum() == robot.model.nv - len(robot.axes)
    for row in rows:
        q = robot.q(row)
        pushed = q + rng.normal(size=len(q)) * 1e-3 * passive
        assert closure.gap(pushed) > 1e-6
        assert np.abs(closure.polished(pushed) - q).max() < 1e-9


@pytest.mark.parametrize("name", MACHINES)
def test_the_jacobian_is_that_of_the_constraints(name: str) -> None:
    """What Pinocchio's own constraints leave of the joints' velocities is what the map's elimination says."""
    robot, rows = states(name, 25)
    closure = closure_of(robot)
    for row in rows:
        q = robot.q(row)
        _, constraints = closure.error(q)
        rates = robot.chain.axis_map.dq_daxes(row)
        assert np.abs(constraints @ rates).max() < 1e-9 * max(1.0, np.abs(rates).max())
        step = 1e-5
        for n, factor in enumerate(robot.kinematics.si_factors):
            ahead, behind = (robot.fk(row + sign * step / factor * np.eye(len(row))[n]) for sign in (1.0, -1.0))
            moved = (ahead.translation - behind.translation) / (2.0 * step)
            expected = robot.fk(row).rotation @ robot.jacobian(row)[:3, n]
            assert np.abs(moved - expected).max() < 1e-6


def test_the_same_axes_give_the_same_pose_after_any_other_call() -> None:
    robot, rows = states("delta_kin37", 20)
    first = [robot.fk(row).homogeneous for row in rows]
    for row in rows[::-1]:
        robot.fk(row)
        robot.ik(robot.fk(row))
        robot.jacobian(row)
    assert all((robot.fk(row).homogeneous == T).all() for row, T in zip(rows, first, strict=True))


def test_what_does_not_close_names_the_rod_and_by_how_much() -> None:
    robot = Robot.load("tripod_kin12")
    with pytest.raises(ChainbuildError, match=r"those of Z1 and Z3 together are 2839\.65 mm too short"):
        robot.fk([5000.0, 900.0, 900.0])  # √(3 · 330² + 4100²) - 2 · 650
    with pytest.raises(ChainbuildError, match=r"the rod of Z[13] is [0-9.]+ mm too short for where the others") as told:
        robot.fk([900.0, 900.0, 2050.0])
    assert told.value.parameter in {"Z1", "Z3"}
    T = robot.fk([900.0, 900.0, 900.0])
    T.translation[0] += 1.0
    found = robot.ik(T)
    assert found.status == "unreachable"
    assert "the rod of Z" in found.reason
    assert "mm too short" in found.reason
    apart = Robot.load("lambda_kin21")
    with pytest.raises(ChainbuildError, match=r"the rods do not meet: .* 1[0-9.]+ mm too short"):
        apart.fk([-900.0, 1000.0, 200.0, 0.0])


def test_check_refuses_loops_that_leave_other_freedoms_than_the_axes() -> None:
    robot = Robot.load("delta_kin37")
    fewer = Robot(replace(robot.chain, loops=robot.chain.loops[:2]))
    with pytest.raises(ChainError, match="leave 6 freedoms for 3 axes"):
        check_closure(fewer)
    moved = [
        replace(frame, T_link_frame=frame.T_link_frame + np.diag([0.0] * 4) + np.eye(4, k=3) * 1e-3)
        if frame.name.endswith("J1_pin")
        else frame
        for frame in robot.chain.frames
    ]
    with pytest.raises(ChainError, match=r"do not close: a gap of 0\.001 m"):
        check_closure(Robot(replace(robot.chain, frames=tuple(moved))))


def test_only_balls_close() -> None:
    robot = Robot.load("delta_kin37")
    hinge = replace(robot.chain.loops[0], kind="hinge")
    with pytest.raises(ChainError, match="only balls close here"):
        Closure(robot, [hinge])


@pytest.mark.parametrize("name", ["parallelogram_nr", "palletiser_kin96"])
def test_the_parallelogram_as_a_loop_agrees_with_the_affine_rows(name: str) -> None:
    """Crank and rod closed by a ball: the affine rows close it, and outside the flat band Newton comes back to them."""
    robot = Robot(with_rods(Robot.load(name).chain, RodData()))
    closure = Closure(robot, [Loop("rod", "ball", ROD_END, ROD_PIN)])
    names = [joint.name for joint in robot.chain.joints]
    crank, rod = names.index(CRANK), names.index(ROD)
    rng = np.random.default_rng(8)
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    polished = 0
    for _ in range(300):
        q = robot.q(lower + (upper - lower) * rng.random(len(lower)))
        assert closure.gap(q) < 1e-12
        _, J = closure.error(q)
        values = np.linalg.svd(J[:, [crank, rod]], compute_uv=False)
        if values[1] < np.sin(np.radians(0.5)) * values[0]:
            continue  # the band in which crank and rod lie in line: closed to 6e-15 they are open to 1e-7 rad
        polished += 1
        pushed = q.copy()
        pushed[[crank, rod]] += rng.normal(size=2) * 1e-4
        assert np.abs(closure.polished(pushed, np.array([crank, rod])) - q).max() < 1e-11
    assert polished > 200
