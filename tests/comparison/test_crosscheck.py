"""Cross-check: agreement is seen, every planted fault is named, conventions are decided by a recording."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild import frames
from chainbuild.comparison.convention_trials import Selection
from chainbuild.comparison.crosscheck import CheckOptions, CrossCheck, crosscheck
from chainbuild.comparison.samples import make_samples
from chainbuild.errors import ChainbuildError
from chainbuild.robot import Robot
from chainbuild.tables.recording import Recording
from chainbuild.writers.report import crosscheck_text
from tests.kit.robots import arm, table_machine

FEW = CheckOptions(count=60)
OFFSET = frames.f_frame((0.02, -0.01, 0.3), (10.0, 20.0, 30.0))


@pytest.fixture(scope="module")
def robot() -> Robot:
    return chainbuild.Robot.load("kr6r900_2")


def recorded(robot: Robot, change=lambda T: T, axes_change=lambda a: a, count: int = 40) -> Recording:
    """Return what a controller would show whose model differs from the robot's."""
    axes = make_samples(robot, count, ("random",)).axes
    poses = np.array([change(robot.fk(axes_change(row.copy())).homogeneous) for row in axes])
    return Recording(axes, poses)


def named(robot: Robot, recording: Recording) -> CrossCheck:
    found = crosscheck(robot, recording)
    assert not found.agrees
    assert found.explanation is not None
    assert found.explanation.remaining_position_error < 1e-6
    return found


def test_equal_poses_agree(robot: Robot) -> None:
    found = crosscheck(robot, recorded(robot))
    assert found.agrees
    assert found.explanation is None
    assert found.forward is not None
    assert found.forward.position_error.max() == 0.0


@pytest.mark.parametrize("solver", ["eaik", "opw", pytest.param("roboticstoolbox", marks=pytest.mark.slow)])
def test_independent_solvers_agree(robot: Robot, solver: str) -> None:
    found = crosscheck(robot, solver, options=FEW)
    assert found.agrees, found
    assert found.forward is not None
    assert len(found.forward.samples) >= 55
    if found.inverse is not None:
        assert found.inverse.ours > 100
        assert found.inverse.outside > 0  # they know no limits


@pytest.mark.parametrize("solver", ["eaik", "opw"])
def test_a_solver_for_another_kinematic_is_refused(solver: str) -> None:
    with pytest.raises(ChainbuildError, match="does not support this kinematic"):
        crosscheck(table_machine(), solver, options=FEW)


def test_an_unknown_solver_is_refused(robot: Robot) -> None:
    with pytest.raises(ChainbuildError, match="unknown solver 'best'"):
        crosscheck(robot, "best")
    with pytest.raises(ChainbuildError, match="cannot be imported"):
        crosscheck(robot, "no_such_module:fk")


def test_a_tool_offset_is_named(robot: Robot) -> None:
    found = named(robot, recorded(robot, lambda T: T @ OFFSET))
    assert found.explanation.kind == "tool offset"
    assert "(20, -10, 300) mm" in found.explanation.text


def test_a_base_offset_is_named(robot: Robot) -> None:
    found = named(robot, recorded(robot, lambda T: frames.translation(0.0, 0.4, 0.0) @ T))
    assert found.explanation.kind == "base offset"
    assert "(0, 400, 0) mm in the workpiece frame" in found.explanation.text


@pytest.mark.parametrize("n", range(6))
def test_a_flipped_axis_is_named(robot: Robot, n: int) -> None:
    signs = np.ones(6)
    signs[n] = -1.0
    found = named(robot, recorded(robot, axes_change=lambda a: a * signs))
    assert found.explanation.kind == "flipped axis"
    assert found.explanation.axes == (robot.axes[n].name,)


def test_two_flipped_axes_are_named(robot: Robot) -> None:
    found = named(robot, recorded(robot, axes_change=lambda a: a * [-1, 1, 1, -1, 1, 1]))
    assert found.explanation.axes == ("C1", "A1")


def test_a_swapped_pair_is_named(robot: Robot) -> None:
    found = named(robot, recorded(robot, axes_change=lambda a: a[[0, 1, 2, 5, 4, 3]]))
    assert (found.explanation.kind, found.explanation.axes) == ("swapped axes", ("A1", "A2"))


@pytest.mark.parametrize(("n", "shift"), [(1, 90.0), (2, -3.25), (4, 180.0), (3, 0.01)])
def test_a_wrong_zero_is_named(robot: Robot, n: int, shift: float) -> None:
    zero = np.zeros(6)
    zero[n] = shift
    found = named(robot, recorded(robot, axes_change=lambda a: a + zero))
    assert found.explanation.kind == "axis zero"
    assert found.explanation.axes == (robot.axes[n].name,)
    value = float(found.explanation.text.split("off by ")[1].split()[0])
    assert abs((value - shift + 180.0) % 360.0 - 180.0) < 1e-6


def test_a_wrong_zero_of_a_linear_axis_is_named() -> None:
    table = table_machine()
    axes = make_samples(table, 30, ("random",)).axes
    moved = axes + [0.0, 7.5, 0.0, 0.0, 0.0]
    poses = np.array([table.fk(row).homogeneous for row in moved])
    for compared in ("pose", "direction", "position"):
        found = named(table, Recording(axes, poses, compared))
        assert "7.5" in found.explanation.text


def test_another_angle_convention_is_named(robot: Robot) -> None:
    def misread(T: np.ndarray) -> np.ndarray:
        # The controller shows A, B, C in mode cba; the recording is read in the chain's own mode.
        shown = frames.angles_from_matrix("cba", T[:3, :3])
        return frames.transform(frames.matrix_from_angles(robot.chain.angle_mode, shown), T[:3, 3])

    found = named(robot, recorded(robot, misread))
    assert found.explanation.kind == "angle convention"
    assert "mean orirpy or cba, R = Rz(A)·Ry(B)·Rx(C), not ypr" in found.explanation.text


def test_other_readings_of_a_pose_are_named(robot: Robot) -> None:
    def transposed(T: np.ndarray) -> np.ndarray:
        return frames.transform(T[:3, :3].T, T[:3, 3])

    def in_mm(T: np.ndarray) -> np.ndarray:
        return frames.transform(T[:3, :3], 1000.0 * T[:3, 3])

    assert named(robot, recorded(robot, transposed)).explanation.kind == "transposed rotation"
    assert named(robot, recorded(robot, frames.inverse)).explanation.kind == "inverse pose"
    assert named(robot, recorded(robot, in_mm)).explanation.text == "positions: millimetres taken for metres"


@pytest.mark.parametrize(
    ("factor", "text"),
    [
        (1e-3, "metres taken for millimetres"),
        (1.0 / 0.0254, "inches taken for metres"),
        (1.0 / 25.4, "inches taken for millimetres"),
    ],
)
def test_another_unit_of_length_is_named(robot: Robot, factor: float, text: str) -> None:
    found = named(robot, recorded(robot, lambda T: frames.transform(T[:3, :3], factor * T[:3, 3])))
    assert (found.explanation.kind, found.explanation.text) == ("unit of length", f"positions: {text}")


def test_radians_are_named(robot: Robot) -> None:
    def misread(T: np.ndarray) -> np.ndarray:
        shown = frames.angles_from_matrix(robot.chain.angle_mode, T[:3, :3])
        return frames.transform(frames.matrix_from_angles(robot.chain.angle_mode, np.radians(shown)), T[:3, 3])

    in_degrees = recorded(robot)
    in_radians = Recording(np.radians(in_degrees.axes), in_degrees.poses, in_degrees.compared, "r.csv")
    for recording, what in ((recorded(robot, misread), "pose angles"), (in_radians, "rotary axes")):
        found = named(robot, recording).explanation
        assert (found.kind, found.text) == ("unit of angle", f"{what}: radians taken for degrees")


def test_two_faults_at_once_are_named(robot: Robot) -> None:
    signs = np.array([1, 1, 1, -1, 1, 1])
    found = named(robot, recorded(robot, lambda T: T @ OFFSET, lambda a: a * signs))
    assert found.explanation.kind == "flipped axis + tool offset"
    assert found.explanation.axes == ("A1",)


def test_noise_has_no_structure(robot: Robot) -> None:
    rng = np.random.default_rng(1)
    found = crosscheck(robot, recorded(robot, lambda T: T @ pin.SE3(pin.exp6(0.05 * rng.normal(size=6))).homogeneous))
    assert not found.agrees
    assert found.explanation is None


def test_a_function_with_poses(robot: Robot) -> None:
    def forward(axes: np.ndarray) -> np.ndarray:
        return robot.fk(axes).homogeneous

    found = crosscheck(robot, forward, options=FEW)
    assert found.agrees
    assert found.inverse is None
    assert found.reference == "forward"


def test_a_function_with_branches(robot: Robot) -> None:
    def first_only(T: np.ndarray) -> list[np.ndarray]:
        return [branch.axes for branch in robot.ik_all(T)[:1]]

    def all_of_them(T: np.ndarray) -> list[np.ndarray]:
        return [branch.axes for branch in robot.ik_all(T)]

    assert crosscheck(robot, all_of_them, options=FEW).agrees
    found = crosscheck(robot, first_only, options=FEW)
    assert not found.agrees
    assert found.inverse is not None
    assert found.inverse.missing > 0
    assert (found.inverse.wrong, found.inverse.extra) == (0, 0)


def test_wrong_answers_are_counted_and_explained(robot: Robot) -> None:
    def mirrored(T: np.ndarray) -> list[np.ndarray]:
        return [branch.axes * [1, 1, 1, 1, 1, -1] for branch in robot.ik_all(T)]

    found = crosscheck(robot, mirrored, options=FEW)
    assert found.inverse is not None
    assert found.inverse.wrong > 0
    assert found.inverse.unanswered > 0
    assert found.explanation is not None
    assert (found.explanation.kind, found.explanation.axes) == ("flipped axis", ("A2",))


def test_a_function_with_nonsense_is_refused(robot: Robot) -> None:
    with pytest.raises(ChainbuildError, match="neither a pose nor a list"):
        crosscheck(robot, lambda _: [1.0, 2.0], options=FEW)

    def fails(_: np.ndarray) -> np.ndarray:
        raise ZeroDivisionError("by zero")

    with pytest.raises(ChainbuildError, match="ZeroDivisionError"):
        crosscheck(robot, fails, options=FEW)


def test_the_conventions_that_would_make_a_recording_agree() -> None:
    machine = chainbuild.load("table_ac_kin58") if "table_ac_kin58" in chainbuild.shipped() else None
    machine = machine or chainbuild.load(next(name for name in chainbuild.shipped() if "kin58" in name))
    there = chainbuild.Robot(machine.chain(conventions={"table_rotary_sense": "left_handed"}))
    here = chainbuild.Robot(machine.chain())
    axes = make_samples(here, 40, ("random",)).axes
    recording = Recording(axes, np.array([there.fk(row).homogeneous for row in axes]))
    found = crosscheck(here, recording, machine=machine, selection=Selection())
    assert not found.agrees
    assert {"table_rotary_sense": "left_handed"} in [dict(trial.choices) for trial in found.deciding]


def test_conventions_that_change_no_pose_are_not_tried() -> None:
    machine = chainbuild.load("arm_nn")
    there = chainbuild.Robot(machine.chain(conventions={"nn": "zyx"}))
    here = chainbuild.Robot(machine.chain())
    assert "singularity_measure" in {used.convention.name for used in here.chain.conventions}
    axes = make_samples(here, 20, ("random",)).axes
    recording = Recording(axes, np.array([there.fk(row).homogeneous for row in axes]))
    found = crosscheck(here, recording, machine=machine, selection=Selection())
    assert {name for trial in found.trials for name in trial.choices} == {"nn"}


def test_samples_are_repeatable_and_inside_the_limits() -> None:
    robot = arm()
    one, other = make_samples(robot, 90, seed=3), make_samples(robot, 90, seed=3)
    np.testing.assert_array_equal(one.axes, other.axes)
    assert {"random", "grid", "singular"} == set(one.kinds)
    assert all(robot.violated_limits(row) == () for row in one.axes)
    special = one.axes[[kind == "singular" for kind in one.kinds]]
    assert (special[:, 4] == 0.0).any()
    assert (special[:, 0] == 90.0).any()
    with pytest.raises(ChainbuildError, match="unknown samples 'all'"):
        make_samples(robot, 10, ("all",))


def test_bad_tolerances_are_refused(robot: Robot) -> None:
    with pytest.raises(ChainbuildError, match="tolerance"):
        crosscheck(robot, recorded(robot), options=CheckOptions(position_tolerance=0.0))


def test_a_table_is_shown_by_its_counts(robot: Robot) -> None:
    poses = np.array([robot.fk([0, -90, 90, 0, 30, k]).homogeneous for k in range(3)])
    poses[1, :3, 3] *= 9.0
    assert repr(robot.ik_batch(poses)) == "<IkTable of 3 rows: 2 ok, 1 unreachable; .axes, .status, .reasons(), [row]>"
    assert repr(robot.ik_batch(poses[:0])).startswith("<IkTable of 0 rows: none;")


def test_a_solver_that_writes_into_its_argument_is_compared_at_the_sample(robot: Robot) -> None:
    def reversed_a6(axes: np.ndarray) -> np.ndarray:
        axes[5] = -axes[5]
        return robot.fk(axes).homogeneous

    def constant(axes: np.ndarray) -> np.ndarray:
        axes[:] = 0.0
        return robot.fk(axes).homogeneous

    found = crosscheck(robot, reversed_a6, options=FEW)
    assert found.explanation is not None
    assert (found.explanation.kind, found.explanation.axes) == ("flipped axis", ("A2",))
    assert not crosscheck(robot, constant, options=FEW).agrees


def test_a_solver_that_returns_one_buffer_agrees(robot: Robot) -> None:
    buffer = np.eye(4)

    def forward(axes: np.ndarray) -> np.ndarray:
        buffer[:] = robot.fk(axes).homogeneous
        return buffer

    row = np.zeros(6)

    def branches(T: np.ndarray):
        for branch in robot.ik_all(T.copy()):
            row[:] = branch.axes
            yield row

    def overwrites(T: np.ndarray) -> list[np.ndarray]:
        found = [branch.axes for branch in robot.ik_all(T.copy())]
        T[:] = np.eye(4)
        return found

    few = CheckOptions(count=15)
    found = crosscheck(robot, forward, options=few)
    assert found.agrees
    assert found.forward is not None
    assert len({T.tobytes() for T in found.forward.theirs}) == len(found.forward.samples)
    for inverse in (branches, overwrites):
        checked = crosscheck(robot, inverse, options=few)
        assert checked.agrees, checked
        assert checked.inverse is not None
        assert checked.inverse.ours > 10


def test_a_result_does_not_share_a_recording(robot: Robot) -> None:
    recording = recorded(robot, count=5)
    found = crosscheck(robot, recording).forward
    assert found is not None
    axes, poses = found.samples.axes.copy(), found.theirs.copy()
    recording.axes[:] = 7.0
    recording.poses[:] = 7.0
    np.testing.assert_array_equal(found.samples.axes, axes)
    np.testing.assert_array_equal(found.theirs, poses)


def test_differences_of_rotation_alone_have_no_table(robot: Robot) -> None:
    found = crosscheck(robot, recorded(robot, lambda T: T @ frames.f_frame((0.0, 0.0, 0.0), (10.0, 0.0, 0.0))))
    assert "dx_mm" not in crosscheck_text(found)


def test_differences_are_theirs_minus_ours(robot: Robot) -> None:
    found = crosscheck(robot, recorded(robot, lambda T: frames.translation(0.0, 0.4, -0.1) @ T)).forward
    assert found is not None
    np.testing.assert_allclose(found.difference, np.tile([0.0, 0.4, -0.1], (40, 1)), atol=1e-12)


def test_an_inverse_that_fails_later_is_named(robot: Robot) -> None:
    calls = iter(range(1000))

    def sometimes(T: np.ndarray) -> list[np.ndarray]:
        if next(calls) > 4:
            raise ZeroDivisionError("by zero")
        return [branch.axes for branch in robot.ik_all(T)]

    with pytest.raises(ChainbuildError, match="sometimes fails: ZeroDivisionError: by zero"):
        crosscheck(robot, sometimes, options=FEW)
