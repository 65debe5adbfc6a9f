"""What a control compares with its thresholds for singularities: the choices of convention `singularity_measure`.

one_minus_cosine       least 1 - √(1 - s²) of the factors s; where they do not tell all, `smallest`
smallest               smallest scaled singular value
product                product of the scaled singular values
determinant_squared    its square
"""

from __future__ import annotations

import numpy as np

from chainbuild.analysis.singularity.jacobians import pose_jacobians
from chainbuild.analysis.singularity.measures import scaling_of
from chainbuild.analysis.vanishing.functions import singular_functions
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.kinematics.mechanism import Mechanism

MEASURES = ("one_minus_cosine", "determinant_squared", "product", "smallest")


def measure_in_force(robot: Mechanism, chosen: str) -> str:
    """Return the measure that a robot is judged by where `chosen` is the convention's choice."""
    if chosen == "one_minus_cosine" and not singular_functions(robot).complete:
        return "smallest"
    return chosen


def measure_of_factor(s: float) -> float:
    """Return 1 - √(1 - s²) of a factor; 1 from s = 1 on."""
    s = min(abs(s), 1.0)
    return s * s / (1.0 + float(np.sqrt((1.0 - s) * (1.0 + s))))


def factor_of_measure(value: float) -> float:
    """Return the factor s of which 1 - √(1 - s²) is a value; 1 from 1 on."""
    value = min(max(value, 0.0), 1.0)
    return float(np.sqrt(value * (2.0 - value)))


def joint_rows(robot: Mechanism, axes: Matrix) -> Matrix:
    """Return joint values (n, n_q) of a robot whose axis map is affine at axis values (n, n_axes)."""
    axis_map = robot.chain.axis_map
    assert isinstance(axis_map, AffineMap)
    return axis_map.q_rows(axes)


def control_values(robot: Mechanism, measure: str, axes: Matrix) -> Vector:
    """Return the measure (n,) at axis values (n, n_axes), mm and degrees; inf where there is no pose.

    Args:
        robot: The robot.
        measure: Of `measure_in_force`.
        axes: Axis values; limits are ignored.
    """
    found = np.full(len(axes), np.inf)
    known = np.flatnonzero(np.isfinite(axes).all(axis=1))
    if measure == "one_minus_cosine":
        q = joint_rows(robot, axes[known])
        functions = singular_functions(robot).functions
        values = [np.abs(np.cos(q @ f.multiples.T + f.phases) @ f.amplitudes) for f in functions]
        found[known] = [measure_of_factor(s) for s in np.min(values, axis=0).tolist()]
        return found
    scaling = scaling_of(robot)
    for part, _, J in pose_jacobians(robot, axes[known]):
        scaled = scaling.apply(J)
        posed = np.isfinite(scaled.reshape(len(scaled), -1)).all(axis=1)
        singular = np.linalg.svd(scaled[posed], compute_uv=False)
        values_here = singular[:, -1] if measure == "smallest" else singular.prod(axis=1)
        found[known[part][posed]] = values_here**2 if measure == "determinant_squared" else values_here
    return found
