"""Bounds of rates against dense differences, and the singular functions against the determinant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild.analysis.path.motion import LineMotion, motion_of
from chainbuild.analysis.path.nearby import _arm_on
from chainbuild.analysis.singularity.measures import scaling_of
from chainbuild.analysis.vanishing import functions
from chainbuild.analysis.vanishing.functions import SingularFunction, singular_functions
from chainbuild.analysis.vanishing.line import line_geometry
from chainbuild.analysis.vanishing.linetraced import ElbowTraced, PoleTraced, ShoulderTraced, WristTraced, vector_lines
from chainbuild.analysis.vanishing.rates import jacobian_rates
from chainbuild.analysis.vanishing.tracing import Traced
from chainbuild.chain.axismap import AffineMap
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from tests.kit.aimed_lines import lines_of

AFFINE = [name for name in shipped() if isinstance(Robot.load(name).chain.axis_map, AffineMap)]


def random_rows(robot: Robot, count: int, seed: int) -> np.ndarray:
    lower = np.array([max(axis.lower, -400.0) for axis in robot.axes])
    upper = np.array([min(axis.upper, 400.0) for axis in robot.axes])
    return np.random.default_rng(seed).uniform(lower, np.maximum(lower, upper), (count, len(lower)))


def fastest_change(robot: Robot, first: np.ndarray, last: np.ndarray, samples: int) -> float:
    """Return the largest rate of the scaled Jacobian over a block, by differences: a chord is never above the rate."""
    scaling = scaling_of(robot)
    t = np.linspace(0.0, 1.0, samples)
    scaled = np.array([scaling.apply(robot.jacobian(first + x * (last - first))) for x in t])
    return float(np.linalg.norm(np.diff(scaled, axis=0), axis=(1, 2)).max() * (samples - 1))


@pytest.mark.parametrize("name", AFFINE)
def test_no_jacobian_changes_faster_than_its_bound(name: str) -> None:
    robot = Robot.load(name)
    rows = random_rows(robot, 4, 5)
    bounds = jacobian_rates(robot, rows, scaling_of(robot))
    for n, bound in enumerate(bounds.tolist()):
        assert fastest_change(robot, rows[n], rows[n + 1], 60) <= bound * (1.0 + 1e-12)
    for column in range(len(robot.axes)):  # one axis alone: what the sum of all hides
        alone = rows[[0, 0]].copy()
        alone[1, column] += 40.0
        (bound,) = jacobian_rates(robot, alone, scaling_of(robot)).tolist()
        assert fastest_change(robot, alone[0], alone[1], 12) <= bound * (1.0 + 1e-12) + 1e-12


def check_steps(traced: Traced, blocks: np.ndarray, samples: int) -> None:
    """Within the step from a place the margin changes by no more than its size there."""
    for t in np.linspace(0.0, 0.95, samples):
        at = np.full(len(blocks), t)
        margins = traced.margins(blocks, at)
        steps = np.minimum(traced.steps(blocks, at, np.abs(margins)), 1.0 - t)
        for share in np.linspace(0.1, 1.0, 10):
            beyond = traced.margins(blocks, at + share * steps)
            known = np.isfinite(margins) & np.isfinite(beyond)
            assert (np.abs(beyond - margins)[known] <= np.abs(margins)[known] * (1.0 + 1e-9) + 1e-9).all()


@pytest.mark.parametrize("name", ["kr6r900", "tx2_60", "comau_calibrated"])
def test_steps_on_lines_are_no_longer_than_the_margin_allows(name: str) -> None:
    lines, rng = lines_of(name), np.random.default_rng(6)
    for n in range(4):
        rows = lines.random(rng, 2)[0] if n % 2 else lines.aimed(("wrist", "shoulder")[n // 2], rng, 2)[0]
        motion = motion_of(lines.robot, rows, "cp")
        assert isinstance(motion, LineMotion)
        on = _arm_on(motion, motion.lines, np.array([0]), 0.02)
        assert on is not None and on.arm.wrist is not None
        for traced in (ShoulderTraced(on), ElbowTraced(on), WristTraced(on, on.arm.wrist)):
            check_steps(traced, np.array([0]), 25)


@pytest.mark.parametrize("name", ["ca_head_kin9", "ac_table_kin58", "cardan_head_kin60"])
def test_steps_of_vectors_are_no_longer_than_the_margin_allows(name: str) -> None:
    robot = Robot.load(name)
    poses = robot.fk_batch(random_rows(robot, 40, 7))
    geometry = line_geometry(robot, np.empty(0))
    assert geometry is not None and geometry.bend is not None
    traced = PoleTraced(vector_lines(poses, robot.chain.tool_column), geometry.bend, 0.02)
    check_steps(traced, np.arange(39), 25)


def ratios(robot: Robot, known: tuple[SingularFunction, ...]) -> np.ndarray:
    """Return the scaled volume of Jacobians over the product of the functions, at random axis values."""
    scaling, found = scaling_of(robot), []
    for axes in random_rows(robot, 60, 9):
        J = scaling.apply(robot.jacobian(axes))
        volume = np.sqrt(max(np.linalg.det(J @ J.T if J.shape[0] < J.shape[1] else J.T @ J), 0.0))
        product = np.prod([np.cos(f.multiples @ robot.q(axes) + f.phases) @ f.amplitudes for f in known])
        if abs(product) > 1e-3:
            found.append(volume / abs(product))
    assert len(found) > 10
    return np.array(found)


COMPLETE = [name for name in AFFINE if singular_functions(Robot.load(name)).complete]


@pytest.mark.parametrize("name", COMPLETE)
def test_the_functions_of_a_complete_robot_are_its_determinant(name: str) -> None:
    robot = Robot.load(name)
    known = singular_functions(robot).functions
    found = ratios(robot, known)
    assert np.ptp(found) < 1e-7 * found[0]
    for n, function in enumerate(known):  # a sign of any term that has a counterpart
        if len(function.amplitudes) > 1:
            amplitudes = function.amplitudes.copy()
            amplitudes[0] *= -1.0
            wrong = ratios(robot, (*known[:n], replace(function, amplitudes=amplitudes), *known[n + 1 :]))
            assert np.ptp(wrong) > 1e-3 * wrong[0]


def test_known_robots_are_complete() -> None:
    assert {"kr6r900", "tx2_60", "irb2600", "comau_calibrated", "ca_head_kin9", "parallelogram_nr"} <= set(COMPLETE)
    assert not {"arm_nn", "arm_rr", "gantry_robot_kin210"} & set(COMPLETE)


@pytest.mark.parametrize("kind", ["wrist", "elbow", "shoulder"])
def test_a_wrong_factor_is_not_believed(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    right = functions.signed_factors

    def wrong(robot: Robot, lines: object) -> dict[str, float]:
        found = dict(right(robot, lines))
        found[kind] = abs(found[kind])  # the sign is lost: no sum of cosines
        return found

    monkeypatch.setattr(functions, "signed_factors", wrong)
    assert not singular_functions(Robot.load("kr6r900")).complete
