"""Measures and speeds against plain linear algebra."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.singularity.jacobians import pose_jacobians
from chainbuild.analysis.singularity.measures import measure, measure_batch, scaling_of, smallest_value
from chainbuild.analysis.singularity.speeds import speeds
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.errors import ChainbuildError

MACHINES = ["kr6r900", "ac_table_kin58", "cardan_head_kin59", "plasma_head_kin25", "palletiser_kin96", "scara_kin36"]


def samples(robot: chainbuild.Robot, count: int) -> np.ndarray:
    lower, upper = shown_limits(robot.chain)
    return lower + (upper - lower) * np.random.default_rng(2).uniform(0.1, 0.9, (count, len(lower)))


@pytest.mark.parametrize("name", [*MACHINES, "irb2600_track", "irb2600_table"])
def test_jacobians_in_batch_are_pinocchios(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    axes = samples(robot, 30)
    seen = 0
    for part, positions, J in pose_jacobians(robot, axes):
        for row, position, jacobian in zip(axes[part], positions, J, strict=True):
            np.testing.assert_allclose(jacobian, robot.jacobian(row), atol=1e-12)
            np.testing.assert_allclose(position, robot.fk(row).translation, atol=1e-12)
            seen += 1
    assert seen == 30


@pytest.mark.parametrize("name", MACHINES)
def test_batch_is_the_single_measure(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    axes = samples(robot, 20)
    table = measure_batch(robot, axes)
    for n, row in enumerate(axes):
        single = measure(robot, row)
        assert table.smallest[n] == pytest.approx(single.smallest, abs=1e-12)
        assert smallest_value(robot, row) == pytest.approx(single.smallest, abs=1e-12)
        assert table.manipulability[n] == pytest.approx(single.manipulability, rel=1e-9)
        assert table.condition[n] == pytest.approx(single.condition, rel=1e-6)


def test_lost_and_runaway_are_singular_vectors() -> None:
    robot = chainbuild.Robot.load("kr6r900")
    axes = [10.0, -80.0, 70.0, 20.0, 2.0, 5.0]
    found, scaling = measure(robot, axes), scaling_of(robot)
    J = scaling.apply(robot.jacobian(axes))
    np.testing.assert_allclose(J @ found.runaway, found.smallest * found.lost, atol=1e-12)
    assert np.linalg.norm(found.lost) == pytest.approx(1.0)


def test_the_length_scales_what_is_a_length() -> None:
    robot = chainbuild.Robot.load("kr6r900")
    axes = [10.0, -80.0, 70.0, 20.0, 30.0, 5.0]
    J = robot.jacobian(axes)
    J[:3] /= 0.5
    np.testing.assert_allclose(measure(robot, axes, 0.5).singular_values, np.linalg.svd(J, compute_uv=False))
    for wrong in (0.0, -1.0, float("nan")):
        with pytest.raises(ChainbuildError, match="characteristic length"):
            measure(robot, axes, wrong)


def test_input_axes_are_no_freedoms() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    axes = np.zeros(len(robot.axes))
    held = [n for n, axis in enumerate(robot.axes) if axis.held]
    assert held
    assert (measure(robot, axes).runaway[held] == 0.0).all()


def test_shape_of_batches_is_checked() -> None:
    robot = chainbuild.Robot.load("kr6r900")
    for wrong in ([[0.0] * 5], [0.0] * 6, [[np.nan] * 6]):
        with pytest.raises(ChainbuildError, match="shape"):
            measure_batch(robot, wrong)


def test_speeds_follow_from_the_inverse_jacobian() -> None:
    robot = chainbuild.Robot.load("kr6r900")
    axes = [10.0, -80.0, 70.0, 20.0, 30.0, 5.0]
    inverse = np.linalg.inv(robot.jacobian(axes))
    along = np.array([0.6, 0.0, 0.8])
    found = speeds(robot, axes, 250.0, along)
    expected = np.degrees(np.abs(inverse[:, :3] @ along) * 0.25)
    np.testing.assert_allclose([row.needed for row in found.axes], expected, rtol=1e-9)
    worst = speeds(robot, axes, 250.0)
    np.testing.assert_allclose(
        [row.needed for row in worst.axes], np.degrees(np.linalg.norm(inverse[:, :3], axis=1) * 0.25), rtol=1e-9
    )
    turning = speeds(robot, axes, 30.0, motion="turn")
    np.testing.assert_allclose([r.needed for r in turning.axes], 30.0 * np.linalg.norm(inverse[:, 3:], axis=1))
    assert worst.possible is not None
    again = speeds(robot, axes, worst.possible)
    assert max(row.needed / row.limit for row in again.axes if row.limit) == pytest.approx(1.0)
    assert worst.alarm is None


def test_speeds_blow_up_at_the_singularity() -> None:
    robot = chainbuild.Robot.load("kr6r900")
    near = speeds(robot, [0.0, -90.0, 90.0, 0.0, 0.1, 0.0], 10.0)
    assert near.alarm == 75324
    assert {row.axis.name for row in near.axes if row.excessive} == {"A4", "A6"}
    at = speeds(robot, [0.0, -90.0, 90.0, 0.0, 0.0, 0.0], 10.0)
    assert {row.axis.name for row in at.axes if np.isinf(row.needed)} == {"A4", "A6"}
    assert speeds(chainbuild.Robot.load("kr6r900_2"), [0.0] * 6, 1e6).alarm is None  # ROBX's alarm
    for wrong in (0.0, float("inf"), -1.0):
        with pytest.raises(ChainbuildError, match="speed"):
            speeds(robot, [0.0] * 6, wrong)
    with pytest.raises(ChainbuildError, match="direction"):
        speeds(robot, [0.0] * 6, 10.0, [0.0, 0.0, 0.0])


def test_speeds_are_compared_at_the_drives() -> None:
    """28 geared 2:1 with half of C: the drive turns by 2·A + C/2, whatever the axes may."""
    chain = chainbuild.Robot.load("geared_head_kin28").chain
    robot = chainbuild.Robot(chain.with_drive_limits((chainbuild.DriveLimit(4, max_speed=20.0),)))
    axes, along = [0.0, 0.0, 0.0, 20.0, 40.0], [1.0, 0.5, 0.0]
    found = speeds(robot, axes, 30.0, along, motion="turn")
    plain = speeds(chainbuild.Robot(chain), axes, 30.0, along, motion="turn")
    assert [row.needed for row in found.axes] == pytest.approx([row.needed for row in plain.axes])
    (drive,) = found.drives
    assert (drive.name, drive.limit) == ("A_drive", 20.0)
    # The task leaves the spin about the tool free: five rows, five axes.
    rates = np.linalg.solve(robot.jacobian(axes)[:5], [0.0, 0.0, 0.0, *np.array(along[:2]) / np.linalg.norm(along)])
    assert drive.needed == pytest.approx(30.0 * abs(2.0 * rates[4] + 0.5 * rates[3]), rel=1e-9)
    assert drive.excessive == (drive.needed > 20.0)
    assert found.possible is not None
    assert found.possible <= 30.0 * 20.0 / drive.needed * (1.0 + 1e-12)
    worst = speeds(robot, axes, 30.0, motion="turn").drives[0].needed
    assert worst >= drive.needed
