"""KIN_TYP 98 on its assumed carrier, against a formula written by hand: X, Y, Z, C, A and the law of length."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, MachineDataError, UnsupportedKinematicError
from chainbuild.robot import Robot
from tests.kit.twincat_files import codes, machine

START, END, LIMIT = 20.0, 45.0, 60.0  # HD2, HD3, HD4


def text(hd1: float = 30.0, start: float = START, end: float = END, limit: float = LIMIT) -> str:
    values = "\n".join(f"trafo[0].param[{n}] {value * 1e4:.0f}" for n, value in enumerate((hd1, start, end, limit)))
    return f"trafo[0].id 98\n{values}\nEnde\n"


def robot(length: float = 100.0, conventions: dict[str, str] | None = None, **hd: float) -> Robot:
    return chainbuild.Robot(machine(text(**hd)).chain(tool_length_mm=length, conventions=conventions))


def formula(axes: np.ndarray, length: float, head: float = 0.0) -> np.ndarray:
    """Return the pose in mm: t(x, y, z)·Rz(c)·Rx(a)·t(0, 0, -(head + law))."""
    x, y, z, c, a = axes[0], axes[1], axes[2], np.radians(axes[3]), np.radians(axes[4])
    lean = abs(axes[4])
    law = length if lean <= START else length * np.cos(np.radians(START)) / np.cos(np.radians(min(lean, END)))
    rot_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    rot_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    T = np.eye(4)
    T[:3, :3] = rot_z @ rot_x
    T[:3, 3] = np.array([x, y, z]) + T[:3, :3] @ np.array([0, 0, -(head + law)])
    return T


def random_axes(rng: np.random.Generator) -> np.ndarray:
    return np.array([*rng.uniform(-900, 900, 3), rng.uniform(-350, 350), rng.uniform(-LIMIT, LIMIT)])


@pytest.mark.parametrize(("choice", "head"), [("excluded", 0.0), ("added", 30.0)])
def test_the_pose_follows_the_hand_formula(choice: str, head: float) -> None:
    built = robot(conventions={"kin98_hd1": choice})
    rng = np.random.default_rng(98)
    for axes in (random_axes(rng) for _ in range(500)):
        T, wanted = built.fk(axes), formula(axes, 100.0, head)
        np.testing.assert_allclose(T.translation * 1000.0, wanted[:3, 3], atol=1e-9, rtol=0)
        np.testing.assert_allclose(T.rotation, wanted[:3, :3], atol=1e-12, rtol=0)


def test_the_head_keeps_its_height_between_start_and_end() -> None:
    built = robot()
    heights = [built.fk([0, 0, 0, 30, a]).translation[2] for a in (START, -25.0, 30.0, 40.0, END)]
    assert heights == pytest.approx([heights[0]] * 5, abs=1e-12)


def test_the_jacobian_is_the_derivative() -> None:
    built = robot()
    rng = np.random.default_rng(1)
    step = 1e-6
    for _ in range(50):
        axes = random_axes(rng) * 0.98
        if min(abs(abs(axes[4]) - corner) for corner in (START, END)) < 0.01:
            continue
        J, T = built.jacobian(axes), built.fk(axes)
        for n, factor in enumerate((1e-3, 1e-3, 1e-3, np.pi / 180, np.pi / 180)):
            change = np.zeros(5)
            change[n] = step / factor
            ahead, behind = built.fk(axes + change), built.fk(axes - change)
            linear = T.rotation.T @ (ahead.translation - behind.translation) / (2 * step)
            assert J[:3, n] == pytest.approx(linear, abs=1e-6)
            turn = T.rotation.T @ (ahead.rotation - behind.rotation) / (2 * step)
            assert J[3:, n] == pytest.approx([turn[2, 1], turn[0, 2], turn[1, 0]], abs=1e-6)


@pytest.mark.parametrize("lean", [LIMIT + 1e-6, -LIMIT - 1e-6, 90.0, 200.0])
def test_above_the_limit_there_is_no_pose(lean: float) -> None:
    built = robot()
    for evaluate in (built.fk, built.q, built.jacobian):
        with pytest.raises(ChainbuildError, match=r"the tool leans by .*HD4.*permitted: up to 60 deg") as caught:
            evaluate([0, 0, 0, 0, lean])
        assert caught.value.parameter == "HD4"


@pytest.mark.parametrize("lean", [LIMIT, -LIMIT, 360.0 + LIMIT])
def test_the_limit_itself_counts_as_reached(lean: float) -> None:
    assert np.isfinite(robot().fk([0, 0, 0, 0, lean]).homogeneous).all()


def test_inverse_kinematics_stays_within_the_limit() -> None:
    built = robot()
    assert [(axis.lower, axis.upper) for axis in built.axes if axis.name == "A"] == [(-LIMIT, LIMIT)]
    rng = np.random.default_rng(2)
    for _ in range(10):
        axes = random_axes(rng)
        T = built.fk(axes)
        for solver in ("damped", "analytic"):
            found = built.ik(T, solver=solver)
            assert found.success
            assert np.abs(built.fk(found.axes).translation - T.translation).max() < 1e-6
        assert len(built.ik_all(T)) == 2


def test_the_carrier_is_a_convention() -> None:
    chain = machine(text()).chain()
    used = {entry.convention.name: entry for entry in chain.conventions}
    assert (used["kin98_carrier"].choice, used["kin98_carrier"].convention.mark) == ("ca_head", "?")
    (finding,) = [f for f in chain.findings if f.code == "CB425"]
    assert finding.severity == "warning"
    assert "C/A head" in finding.text
    with pytest.raises(UnsupportedKinematicError, match="neither its axes nor its chain"):
        machine(text()).chain(conventions={"kin98_carrier": "refused"})


def test_angles_that_leave_no_tilt_are_refused() -> None:
    with pytest.raises(MachineDataError, match=r"HD4 is 0 deg.*permitted: an angle above 0"):
        machine(text(limit=0.0)).chain()
    lenient = machine(text(limit=0.0), strict=False)
    with pytest.raises(MachineDataError, match="HD4 is 0 deg"):
        lenient.chain()
    assert "CB401" in codes(lenient)


def test_bounds_of_the_joint() -> None:
    built = robot()
    longest = 0.1 * (np.cos(np.radians(START)) / np.cos(np.radians(END)) - 1.0)
    assert built.model.lowerPositionLimit[5] == 0.0
    assert built.model.upperPositionLimit[5] == pytest.approx(longest)
    assert robot(length=-100.0).model.lowerPositionLimit[5] == pytest.approx(-longest)


def test_without_a_tool_it_is_the_plain_head(tmp_path: Path) -> None:
    built = robot(length=0.0)
    assert built.fk([1, 2, 3, 40, 50]).translation == pytest.approx([0.001, 0.002, 0.003])
    assert chainbuild.write_urdf(built, tmp_path).is_file()


def test_it_stands_in_the_catalogue() -> None:
    entry = chainbuild.catalogue()[98]
    assert [axis.name for axis in entry.axes] == ["X", "Y", "Z", "C", "A"]
    assert {convention.name for convention in entry.conventions} >= {"kin98_hd1", "kin98_carrier"}
