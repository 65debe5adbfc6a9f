"""Newton's method and speeds along lines: what motion of the axes makes a motion of the tool."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.analysis.singularity.jacobians import pose_jacobians
from chainbuild.analysis.singularity.measures import Scaling, scaling_of
from chainbuild.analysis.vanishing.line import rotation_vectors
from chainbuild.arrays import Matrices, Matrix, Vector
from chainbuild.kinematics.mechanism import Mechanism

LINE_DAMPING: Final = 1e-12  # of squared scaled singular values: holds steps finite where one is 0
LARGEST_LINE_STEP: Final = 0.3  # scaled step: beyond it a pose is not linear enough
LINE_STEPS: Final = 12  # Newton steps along a line: from the straight axes 3 or 4 do, next to a singularity more
LINE_MET: Final = 1e-9  # m, rad: an axis value is off by less than a display shows
_LOST: Final = 1e-9  # scaled singular values below this are 0


def jacobians_at(robot: Mechanism, axes: Matrix) -> Matrices:
    """Return the Jacobians (n, 6, n_axes) at axis values (n, n_axes), mm and degrees, all at once."""
    parts = [J for _, _, J in pose_jacobians(robot, axes)]
    return np.concatenate(parts) if parts else np.empty((0, 6, axes.shape[1]))


def newton_steps(robot: Mechanism, x: Matrix, positions: Matrix, rotations: Matrices) -> tuple[Matrix, Vector]:
    """Return Newton's steps (n, n_axes) in SI towards poses, and how far off (n,) [m, rad] the tool is now."""
    scaling, factors = scaling_of(robot), robot.kinematics.si_factors
    axes = x / factors
    poses = robot.fk_batch(axes)
    back = np.swapaxes(poses[:, :3, :3], 1, 2)
    shift = np.einsum("nij,nj->ni", back, positions - poses[:, :3, 3])
    if robot.task == "pose":
        turn = rotation_vectors(back @ rotations)
    else:
        column = robot.chain.tool_column
        turn = np.cross(np.eye(3)[column], np.einsum("nij,nj->ni", back, rotations[:, :, column]))
    error = np.concatenate([shift, turn], axis=1)[:, scaling.rows]
    off = np.abs(error).max(axis=1)
    error[:, scaling.rows < 3] /= scaling.length
    J = scaling.apply(jacobians_at(robot, axes))
    normal = np.swapaxes(J, 1, 2) @ J + LINE_DAMPING * np.eye(J.shape[2])
    steps = np.linalg.solve(normal, np.swapaxes(J, 1, 2) @ error[:, :, None])[:, :, 0]
    largest = np.abs(steps).max(axis=1, keepdims=True)
    steps *= np.minimum(1.0, LARGEST_LINE_STEP / np.maximum(largest, LARGEST_LINE_STEP))
    return unscaled(robot, scaling, steps), off


def struts_at(robot: Mechanism, positions: Matrix, even: Matrix) -> Matrix:
    """Return axis values (n, n_axes) with the tip at positions (n, 3) [m], only the struts other than given ones.

    By Newton's method from the values given; not a number where it does not lead to the position.

    Args:
        robot: A closed chain programmed by position and rotary axes.
        positions: Tips in the workpiece frame.
        even: (n, n_axes) axis values, mm and degrees.
    """
    kinematics, solved = robot.kinematics, list(robot.chain.display.solved)
    found = np.full(even.shape, np.nan)
    for n, x in enumerate(even * kinematics.si_factors):
        for _ in range(LINE_STEPS):
            T, J = kinematics.pose_and_jacobian(x)
            missing = T.rotation.T @ (positions[n] - T.translation)
            off = float(np.linalg.norm(missing))
            if not off > LINE_MET:  # met, or not a number: struts that do not close
                break
            x[solved] += np.linalg.lstsq(J[:3, solved], missing, rcond=None)[0]
        if off <= LINE_MET:
            found[n] = x / kinematics.si_factors
    return found


def unscaled(robot: Mechanism, scaling: Scaling, steps: Matrix) -> Matrix:
    """Return steps of all axes in SI from scaled ones of those that move."""
    linear = np.array([robot.axes[n].kind == "linear" for n in scaling.columns])
    full = np.zeros((len(steps), len(robot.axes)))
    full[:, scaling.columns] = steps * np.where(linear, scaling.length, 1.0)
    return full


def rates_for(robot: Mechanism, axes: Matrix, twist: Matrix, evenly: Matrix) -> Matrix:
    """Return the rates (n, n_axes) in SI that a twist needs; inf where it asks for a motion that is lost.

    Args:
        robot: The robot.
        axes: (n, n_axes) axis values; rows that are not numbers have no rates.
        twist: (n, 6) of the tool in its own frame, over a block.
        evenly: (n, n_axes) what the axes change over the block, SI: where `axes` starts from.
    """
    scaling = scaling_of(robot)
    known = np.asarray(np.isfinite(axes).all(axis=1))
    found = np.full(axes.shape, np.nan)
    if not known.any():
        return found
    J = jacobians_at(robot, axes[known])
    given = evenly[known]  # what is left of the twist is made with least motion: it decides on redundant machines
    rest = (twist[known] - np.einsum("nij,nj->ni", J, given))[:, scaling.rows]
    rest[:, scaling.rows < 3] /= scaling.length
    U, values, Vt = np.linalg.svd(scaling.apply(J), full_matrices=False)
    along = np.einsum("nij,ni->nj", U, rest)
    lost = values < _LOST
    with np.errstate(divide="ignore", invalid="ignore"):
        solved = np.einsum("nij,ni->nj", Vt, np.where(lost, 0.0, along / values))
    endless = np.einsum("nij,ni->nj", np.abs(Vt), np.where(lost & (np.abs(along) > _LOST), 1.0, 0.0)) > _LOST
    rates = unscaled(robot, scaling, solved) + given
    rates[:, scaling.columns] = np.where(endless, np.inf, rates[:, scaling.columns])
    found[known] = rates
    return found
