"""Vectors along the pole, ties and defaults of point-vector programming, worked out by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from chainbuild.arrays import Matrix
from chainbuild.chain.programmed.vectors import VectorProgramming, free_angle, rotation_from_vector
from chainbuild.frames import ANGLE_MODES, rot_x, rot_y, rot_z


@pytest.mark.parametrize(
    ("how", "before", "swing"),
    [
        # From x to y about z: the tool's Y lies along the new vector.
        (VectorProgramming(plane=1), np.eye(3), rot_z(90.0)),
        # From z to x about y: the other axis beside the vector does.
        (VectorProgramming(plane=2, axis="z"), np.eye(3), rot_y(90.0)),
        # The same with the tool turned about its vector: its Y lies along the new vector, then against it.
        (VectorProgramming(plane=2, axis="z"), rot_z(-90.0), rot_y(90.0)),
        (VectorProgramming(plane=2, axis="z"), rot_z(90.0), rot_y(90.0)),
        (VectorProgramming(plane=1), rot_x(90.0), rot_z(90.0)),
    ],
)
def test_a_quarter_turn_to_the_pole(how: VectorProgramming, before: Matrix, swing: Matrix) -> None:
    pole = (0.0, 1.0, 0.0) if how.plane == 1 else (1.0, 0.0, 0.0)
    np.testing.assert_allclose(rotation_from_vector(how, "ypr", pole, before), swing @ before, atol=1e-15)


@pytest.mark.parametrize("noise", [-2e-15, 0.0, 2e-15])
def test_of_two_equally_near_solutions_it_is_the_positive_one(noise: float) -> None:
    """X along z and Z along ±(y × z) = ±x; the tool before is turned by 90 degrees from either, up to rounding."""
    positive = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
    before = positive @ rot_x(90.0 + np.degrees(noise))
    found = rotation_from_vector(VectorProgramming(plane=1), "ypr", (0.0, 0.0, 1.0), before)
    np.testing.assert_allclose(found, positive, atol=1e-12)


@pytest.mark.parametrize("mode", ANGLE_MODES)
def test_the_vector_is_the_tools_x_unless_said_otherwise(mode: Any) -> None:
    assert free_angle(mode) == free_angle(mode, "x")
