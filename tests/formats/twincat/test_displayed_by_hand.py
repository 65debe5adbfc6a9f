"""What is displayed against formulas that another author wrote from the manuals, and the way back, for every type."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.frames import rot_y, rot_z
from tests.hand.displayed import displayed, rotation_of_angles
from tests.kit.random_types import CHOSEN, channel_list, random_axes, random_machine

TYPES = [number for number, kind in chainbuild.catalogue().items() if kind.hd]
VECTORS = 2_000
MACHINES = 4  # of each type: the vectors are shared among them
MODES = {"ypr": 0, "euler_c_first": 1, "cba": 2, "cab": 3, "cba_std": 4, "abc": 5, "ab": 14, "ba": 15}


def machines(
    kin: int, folder: Path, angle_mode: int = 0, **conventions: str
) -> Iterator[tuple[chainbuild.Robot, dict[int, float]]]:
    """Yield random machines of a type with their parameters."""
    rng = np.random.default_rng(kin)
    for _ in range(MACHINES):
        param = random_machine(kin, rng)
        path = folder / "machine.lis"
        text = channel_list(kin, param)
        path.write_text(text.replace("Ende", f"ori_rotation_angle {angle_mode}\nEnde"), "utf-8")
        yield chainbuild.Robot.load(path, conventions=CHOSEN.get(kin, {}) | conventions), param


def differs(shown: Mapping[str, float], wanted: Mapping[str, float]) -> float:
    """Return the largest difference; angles are compared within one turn."""
    assert set(shown) == set(wanted)
    gaps = {name: shown[name] - wanted[name] for name in shown}
    turned = (abs(gap) if name.endswith("_mm") else abs((gap + 180.0) % 360.0 - 180.0) for name, gap in gaps.items())
    return max(turned)


def compare(robot: chainbuild.Robot, kin: int, count: int, rng: np.random.Generator, **more: object) -> None:
    for _ in range(count):
        axes = random_axes(kin, rng)
        T = robot.fk(axes)
        names = dict(zip((axis.name for axis in robot.axes), axes, strict=True))
        wanted = displayed(kin, names, T.rotation, T.translation * 1000.0, **more)  # type: ignore[arg-type]
        assert differs(robot.display(axes), wanted) < 1e-7, axes


@pytest.mark.parametrize("kin", [kin for kin in TYPES if kin != 98])
def test_every_type_shows_what_the_formula_says(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(kin)
    for robot, param in machines(kin, tmp_path):
        compare(robot, kin, VECTORS // MACHINES, rng, params={"hd10": param.get(9, 0)})


@pytest.mark.parametrize("mode", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("kin", [45, 206, 213])
def test_every_angle_mode(kin: int, mode: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(mode)
    for robot, _ in machines(kin, tmp_path, mode):
        compare(robot, kin, 25, rng, angle_mode=mode)


@pytest.mark.parametrize(
    ("kin", "name", "choice", "params"),
    [
        (36, "kin36_c", "absolute", {"kin36_c": "absolute"}),
        (202, "kin202_c", "tool_vector", {"kin202_c": "tool_vector"}),
        (208, "kin208_angles", "pose_angles", {"kin208_angles": "pose"}),
    ],
)
def test_every_choice(kin: int, name: str, choice: str, params: dict[str, object], tmp_path: Path) -> None:
    rng = np.random.default_rng(kin)
    for robot, param in machines(kin, tmp_path, **{name: choice}):
        compare(robot, kin, 100, rng, params={"hd10": param.get(9, 0), **params})


def test_pitch_and_turn_of_the_palletiser(tmp_path: Path) -> None:
    """B is the tilt in the plane of the arm; C does not depend on the plane: so has it the formula, too."""
    rng, checked = np.random.default_rng(213), 0
    for robot, param in machines(213, tmp_path, kin213_angles="pitch_and_turn"):
        sign = -1.0 if param[20] else 1.0
        for _ in range(50):
            axes = random_axes(213, rng)
            shown, R = robot.display(axes), robot.fk(axes).rotation
            a1 = sign * axes[0] - param[35] * 1e-4
            turns = rot_z(a1) @ rot_y(shown["b_deg"]) @ rot_z(shown["c_deg"] - a1)
            np.testing.assert_allclose(turns, R, atol=1e-9)
            names = dict(zip((axis.name for axis in robot.axes), axes, strict=True))
            wanted = displayed(213, names, R, robot.fk(axes).translation, params={"kin213_bc": "pitch_and_sum"})
            assert abs((shown["c_deg"] - wanted["c_deg"] + 180.0) % 360.0 - 180.0) < 1e-9
            back = robot.from_display(shown, start=axes)
            if back.success:
                checked += 1
                assert np.abs(back.axes - axes).max() < 1e-4
    assert checked > 100


@pytest.mark.parametrize("mode", [14, 15])
@pytest.mark.parametrize("kin", [45, 206])
def test_modes_of_two_letters_turn_z_to_the_tool_vector(kin: int, mode: int, tmp_path: Path) -> None:
    """Two pairs of angles do; the formula keeps the first angle within ±90 degrees, we the second one."""
    rng = np.random.default_rng(mode)
    for robot, _ in machines(kin, tmp_path, mode):
        for _ in range(25):
            axes = random_axes(kin, rng)
            shown = robot.display(axes)
            assert list(shown) == ["x_mm", "y_mm", "z_mm", "a_deg", "b_deg"]
            turns = rotation_of_angles(mode, {"A": shown["a_deg"], "B": shown["b_deg"]})
            np.testing.assert_allclose(turns[:, 2], robot.fk(axes).rotation[:, 2], atol=1e-9)
