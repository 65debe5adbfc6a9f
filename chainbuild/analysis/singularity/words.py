"""Sentences about singularities: condition, lost motion, required axis speed."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.analysis.singularity.factors import Factor
from chainbuild.analysis.singularity.measures import Measures
from chainbuild.analysis.singularity.speeds import SpeedReport
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.fold import drawn_values
from chainbuild.closest import and_joined
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.units import deg_from_rad, mm_from_m

_EXACT: Final = 1e-6  # below this nothing is "nearly"
_ALONG_AXIS: Final = 0.985  # cosine of 10 degrees: such a direction is called by its axis
_SHARE: Final = 0.4  # parts of a motion below this share are not mentioned
_RUNS: Final = 0.2  # axes below this share of the fastest do not run away
_REMARK_DEG: Final = 0.5  # a difference that a display of whole degrees would show


def condition(robot: Mechanism, axes: Vector, factor: Factor) -> tuple[str, tuple[str, ...]]:
    """Return the geometric condition and the names of the axes concerned."""
    names = tuple(robot.chain.joints[n].name for n in factor.joints)
    nearly = "" if factor.value < _EXACT else "nearly "
    if factor.kind == "wrist":
        first, middle, last = names
        return f"{first} and {last} are {nearly}parallel ({_value(robot, axes, middle)})", names
    if factor.kind == "elbow":
        upper, elbow = names
        how = "folded" if factor.folded else "stretched"
        return f"the arm is {nearly}{how} at the elbow ({_value(robot, axes, elbow)})", (upper, elbow)
    if factor.kind == "shoulder":
        distance = "" if not nearly else f" but for {mm_from_m(factor.distance):.3g} mm"
        if factor.offset < _EXACT:
            return f"the wrist point lies on axis {names[0]}{distance}", (names[0],)
        radius = mm_from_m(factor.offset)
        return f"the wrist point lies on the cylinder of radius {radius:.4g} mm about axis {names[0]}{distance}", names[
            :1
        ]
    if factor.kind == "pole":
        return f"the tool lies {nearly}along {names[0]}{_others(robot, axes, names[0])}", names
    return f"the tool is {nearly}at the end of its tilt: {names[0]} and {names[1]} swing it the same way", names


def _others(robot: Mechanism, axes: Vector, name: str) -> str:
    """Return the values of the other rotary axes in brackets."""
    shown = [
        _value(robot, axes, axis.name)
        for axis in robot.axes
        if axis.kind == "rotary" and axis.name != name and not axis.held
    ]
    return f" ({', '.join(shown)})" if shown else ""


def _value(robot: Mechanism, axes: Vector, name: str) -> str:
    """Return "A5 = 0.3°" for a joint with the name of an axis, else its name."""
    for axis, value in zip(robot.axes, axes.tolist(), strict=True):
        if axis.name == name:
            shown = round(value, 3) + 0.0
            return f"{name} = {shown:.4g}{'°' if axis.unit == 'deg' else ' mm'}"
    return name


def lost_motion(robot: Mechanism, measures: Measures, turn_first: bool = False) -> str:
    """Return which motion is lost: "rotation about the flange's Y is nearly lost"."""
    frame, back = _shown_frame(robot)
    shift, turn = back @ measures.lost[:3], back @ measures.lost[3:]
    parts = [
        (float(np.linalg.norm(turn)), f"rotation about {_direction(turn, frame)}"),
        (float(np.linalg.norm(shift)), f"motion along {_direction(shift, frame)}"),
    ]
    if not turn_first:
        parts.sort(key=lambda part: -part[0])
    said = [text for size, text in parts if size > _SHARE]
    nearly = "" if measures.smallest < _EXACT else "nearly "
    return f"{' together with '.join(said)} is {nearly}lost"


def _shown_frame(robot: Mechanism) -> tuple[str, Matrix]:
    """Return the frame that directions are said in, and the rotation (3, 3) to it from the tool frame."""
    tool, flange = robot.chain.frame("tool"), robot.chain.frame("flange")
    if tool.link != flange.link:
        return "tool", np.eye(3)
    return "flange", flange.T_link_frame[:3, :3].T @ tool.T_link_frame[:3, :3]


def direction_in_words(robot: Mechanism, vector: Vector) -> str:
    """Return a direction (3,) of the tool frame in words: "the flange's Z"."""
    frame, back = _shown_frame(robot)
    return _direction(back @ vector, frame)


def _direction(vector: Vector, frame: str) -> str:
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        return f"no axis of the {frame}"
    unit = vector / size
    best = int(np.argmax(np.abs(unit)))
    if abs(float(unit[best])) > _ALONG_AXIS:
        return f"the {frame}'s {'XYZ'[best]}"
    sign = 1.0 if unit[best] > 0.0 else -1.0
    shown = ", ".join(f"{round(sign * float(c), 2) + 0.0:g}" for c in unit)
    return f"({shown}) in the {frame} frame"


def runaway_axes(robot: Mechanism, measures: Measures) -> tuple[str, ...]:
    """Return the names of the axes that run away, the fastest first."""
    sizes = np.abs(measures.runaway)
    order = np.argsort(-sizes, kind="stable")
    return tuple(robot.axes[n].name for n in order if sizes[n] > _RUNS * sizes.max())


def cost(report: SpeedReport, measures: Measures) -> str:
    """Return the axis speed that a shift of the tool requires: "10 mm/s at the TCP needs 214°/s of A4"."""
    speed = f"{report.tool_speed:g} mm/s at the TCP"
    if report.motion == "turn":
        speed = f"{report.tool_speed:g}°/s of the tool"
    if measures.smallest < _EXACT:
        endless = [row.axis.name for row in report.axes if math.isinf(row.needed)]
        if endless:
            return f"{speed} in every direction needs infinite speed of {and_joined(endless)}"
        return f"{speed} stays possible, {and_joined([report.axes[n].axis.name for n in _fastest(measures)])} can drift"
    worst = max(report.axes, key=lambda row: row.needed / (row.limit or (360.0 if row.axis.kind == "rotary" else 1e3)))
    unit = "°/s" if worst.axis.unit == "deg" else " mm/s"
    limit = f", which can {worst.limit:g}{unit}" if worst.limit is not None and worst.excessive else ""
    return f"{speed} needs {worst.needed:.3g}{unit} of {worst.axis.name}{limit}"


def _fastest(measures: Measures) -> list[int]:
    sizes = np.abs(measures.runaway)
    return [int(n) for n in np.flatnonzero(sizes > _RUNS * sizes.max())]


def rtcp_remark(robot: Mechanism) -> str:
    """Return when a singular position matters on a kinematic that is programmed by its rotary axes, else nothing."""
    if not robot.chain.solves_linear_axes:
        return ""
    return (
        "only where a vector or an orientation is the target: with the rotary axes programmed the linear ones alone are"
        " solved for, and no position is singular"
    )


def elbow_remark(robot: Mechanism, axes: Vector, factor: Factor) -> str:
    """Return where the manual's "A3 = 0" is not the stretched arm, else an empty string."""
    kinematic, elbow = robot.chain.kinematic, robot.chain.joints[factor.joints[1]].name
    if kinematic == "KIN_TYP 45":
        angle = float(axes[[axis.name for axis in robot.axes].index(elbow)])
        source = "KIN_TYP manual 3.3.4 names A3 (axis B2) = 0, which holds for HD12 = 0 only"
    elif kinematic.endswith(" NR") and isinstance(robot.chain.axis_map, AffineMap):
        angle = deg_from_rad(float(drawn_values(robot.chain.joints, robot.q(axes))[factor.joints[1]]))
        source = "ROBX manual 10.1.3 names A3 = 0, which holds only where TX3P3 has no offset across the forearm"
    else:
        return ""
    off = abs((angle + 90.0) % 180.0 - 90.0)
    if off - deg_from_rad(math.asin(min(factor.value, 1.0))) < _REMARK_DEG:
        return ""
    return f"{source}; here it lies elsewhere"
