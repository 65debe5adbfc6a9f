"""Singularities of closed loops by name: what the axis map says of its struts, with what the tool loses or gains."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.analysis.singularity import words
from chainbuild.analysis.singularity.measures import jacobian_at
from chainbuild.analysis.singularity.singularity import Singularity
from chainbuild.arrays import Vector
from chainbuild.chain.closing import LosingMap, Loss
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.screws import screws_at
from chainbuild.units import mm_from_m, si_factor

_EXACT: Final = 1e-6  # below this nothing is "nearly", as in the other sentences
_MOVES: Final = 1e-9  # a motion of the tool below this is none: a platform's point that only turns


def losses_at(robot: Mechanism, axes: Vector) -> tuple[Loss, ...]:
    """Return the functions of a chain with loops that vanish at singularities, the smallest first; else nothing."""
    axis_map = robot.chain.axis_map
    if not isinstance(axis_map, LosingMap):
        return ()
    return tuple(sorted(axis_map.losses(axes), key=lambda loss: abs(loss.value)))


def named_loss(robot: Mechanism, axes: Vector, loss: Loss, lost: str, cost: str) -> Singularity:
    """Return the singularity of a function at axis values (n_axes,).

    Args:
        robot: A robot with loops.
        axes: Axis values.
        loss: The function.
        lost: Motion that the tool loses, in words.
        cost: Speeds of the axes that a motion of the tool requires, in words.
    """
    size = abs(loss.value)
    condition = loss.condition(size >= _EXACT)
    names = tuple(robot.axes[n].name for n in loss.axes)
    nearly = "nearly " if size >= _EXACT else ""
    if loss.kind == "strut":
        effect = f"{lost}; {cost}"
    elif loss.kind == "platform":
        effect = f"the axes {nearly}let go of the tool{_along(robot, axes, loss)}{_running(robot, axes, loss, size)}"
    else:
        effect = f"the rods {nearly}let the platform turn {_about(robot, axes, loss)}, whatever the axes do"
    value = 0.0 if size < 1e-15 else size  # rounding of unit vectors
    return Singularity(loss.kind, "", value, names, condition, f"{condition}: {effect}", words.rtcp_remark(robot))


def _along(robot: Mechanism, axes: Vector, loss: Loss) -> str:
    """Return in which direction the tool moves by itself."""
    assert loss.rates is not None
    twist = screws_at(robot, robot.q(axes)) @ loss.rates
    if float(np.linalg.norm(twist[:3])) < _MOVES:
        return ""
    return f" along {words.direction_in_words(robot, twist[:3])}"


def _about(robot: Mechanism, axes: Vector, loss: Loss) -> str:
    assert loss.about is not None
    R: Vector = robot.frame_placements(axes)["tool"].rotation
    return f"about {words.direction_in_words(robot, R.T @ loss.about)}"


def _running(robot: Mechanism, axes: Vector, loss: Loss, size: float) -> str:
    """Return how fast the tool follows the axis that drives it most."""
    if size < _EXACT:
        return ", which moves without them"
    J = jacobian_at(robot, axes)[:3]
    rates = {n: float(np.linalg.norm(J[:, n])) * si_factor(robot.axes[n].kind) for n in loss.axes}
    n = max(rates, key=lambda axis: rates[axis])
    unit = "°/s" if robot.axes[n].kind == "rotary" else " mm/s"
    return f": 1{unit} of {robot.axes[n].name} moves the TCP by {mm_from_m(rates[n]):.3g} mm/s"
