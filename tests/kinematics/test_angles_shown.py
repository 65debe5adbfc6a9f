"""Angles that a control displays for a tool vector, a plane and an arm: signs, sides and turns."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.programmed.display import Display
from chainbuild.frames import rot_x, rot_y, rot_z
from chainbuild.kinematics.displayed import pitch_and_turn, plane_angle, two_angles, vector_of_angles

Letter = Literal["x", "y", "z"]
TURNS = {"A": rot_x, "B": rot_y, "C": rot_z}
# Two turns about different axes, and what is left of the axes that they turn to every direction.
PAIRS = [
    (first + second, along)
    for first in "ABC"
    for second in "ABC"
    for along in "xyz"
    if first != second and "xyz".index(along) != "ABC".index(second)
]


def display(letters: str, along: str) -> Display:
    return Display("direction", ("p", "q"), letters=letters, along=along)  # type: ignore[arg-type]


def by_hand(letters: str, along: str, angles: tuple[float, float]) -> np.ndarray:
    first, second = (TURNS[letter](angle) for letter, angle in zip(letters, angles, strict=True))
    return first @ second @ np.eye(3)["xyz".index(along)]


@pytest.mark.parametrize(("letters", "along"), PAIRS)
def test_two_angles_make_the_vector_and_come_back(letters: str, along: str) -> None:
    rng = np.random.default_rng(1)
    shown = display(letters, along)
    for angles in rng.uniform(-179.0, 179.0, (60, 2)).tolist():
        pair = (angles[0], angles[1])
        tool = by_hand(letters, along, pair)
        assert vector_of_angles(shown, pair) == pytest.approx(tool, abs=1e-14)
        alone = two_angles(shown, tool)
        assert -90.0 < alone[0] <= 90.0
        assert by_hand(letters, along, alone) == pytest.approx(tool, abs=1e-12)
        near = (pair[0] + 5.0, pair[1] - 5.0)
        assert two_angles(shown, tool, near) == pytest.approx(pair, abs=1e-9)
        turned = (pair[0] + 720.0, pair[1] - 360.0)
        assert two_angles(shown, tool, turned) == pytest.approx(turned, abs=1e-9)


@pytest.mark.parametrize(("letters", "along"), PAIRS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_where_the_first_angle_has_no_effect_it_stays(letters: str, along: str, sign: float) -> None:
    tool = sign * np.eye(3)["ABC".index(letters[0])]
    shown = display(letters, along)
    alone = two_angles(shown, tool)
    assert alone[0] == 0.0
    assert by_hand(letters, along, alone) == pytest.approx(tool, abs=1e-12)
    near = two_angles(shown, tool, (123.0, alone[1] + 4.0))
    assert near == pytest.approx((123.0, alone[1]), abs=1e-9)


@pytest.mark.parametrize("along", ["x", "y"])
@pytest.mark.parametrize("zero", [0.0, 90.0, -30.0])
def test_the_angle_in_the_plane_counts_from_its_zero(along: Letter, zero: float) -> None:
    shown = Display("plane", ("c_deg",), along=along, zero_deg=zero)
    start = {"x": 0.0, "y": 90.0}[along]
    for turn in (-170.0, -90.0, 0.0, 45.0, 135.0, 180.0):
        found = plane_angle(shown, rot_z(turn))
        assert math.remainder(found - (start + turn - zero), 360.0) == pytest.approx(0.0, abs=1e-9)
        assert -180.0 < found <= 180.0


@pytest.mark.parametrize("name", ["palletiser_kin213", "palletiser_kin96"])
def test_pitch_and_turn_are_those_of_the_factors(name: str) -> None:
    """R = Rz(a)·Ry(B)·Rz(C - a), a being the first axis' turn, for any R of this form."""
    robot = chainbuild.Robot.load(name)
    axes = np.array([(axis.lower + axis.upper) / 2.0 for axis in robot.axes])
    for first in (-100.0, -20.0, 35.0, 80.0):
        axes[0] = first
        q = robot.q(axes)[0]
        a = math.degrees(q) * float(robot.chain.joints[0].direction[2])
        for b, c in ((10.0, 20.0), (-35.0, 100.0), (60.0, -150.0)):
            R = rot_z(a) @ rot_y(b) @ rot_z(c - a)
            assert pitch_and_turn(robot, axes, R) == pytest.approx((b, c), abs=1e-9)
