"""Functions that vanish at singularities of known form, from the joint lines of a position.

Arm, W the wrist point, P the points of the joint lines, a their directions:

    wrist      a4 · (a5 × a6) / |a4 × a5||a5 × a6|    the three wrist axes lie in a plane
    elbow      |(P3 − P2) × (W − P3)| across a2       upper arm and forearm are stretched or folded
    shoulder   a2 · (a1 × (W − P1)) / L               W lies in the plane of axis 1 and a2: on axis 1, or with a
                                                      sideways offset h on the cylinder of radius h about it

Machine with three linear axes, d the tool direction, c the directions of the rotary axes:

    pole       |c × d|                                the tool lies along a rotary axis
    tilt_end   c1 · (c2 × d)                          end of the tilt: both axes move the tool in the same direction

All but the pole's change their sign where they vanish along a motion of the joints. The product of those of a robot
is the determinant of its Jacobian where nothing else can be lost; `chainbuild.analysis.vanishing.functions` tests that.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.analysis.singularity.structure import (
    ArmForm,
    CartesianForm,
    Lines,
    SingularityKind,
    SingularStructure,
    WristForm,
    nearest_point_to_lines,
)
from chainbuild.arrays import Vector
from chainbuild.chain.elements import Task

_ZERO_ARM: Final = 1e-9  # m
_PARALLEL: Final = 1e-12  # product of two sines: rounding of right data is 1e-16


@dataclass(frozen=True, slots=True, eq=False)
class Factor:
    """One function that vanishes at a singularity.

    Attributes:
        kind: Its name.
        signed: 0 at the singularity, about ±1 far from it; without unit.
        joints: Joints involved.
        offset: Shoulder: sideways offset of the wrist point from axis 1 [m].
        distance: Shoulder: distance of the wrist point from its singular place [m].
        folded: Elbow: True where the forearm lies back on the upper arm.
    """

    kind: SingularityKind
    signed: float
    joints: tuple[int, ...]
    offset: float = 0.0
    distance: float = 0.0
    folded: bool = False

    @property
    def value(self) -> float:
        """0 at the singularity, about 1 far from it; without unit."""
        return abs(self.signed)


def factors(structure: SingularStructure, lines: Lines, task: Task, tool_direction: Vector) -> tuple[Factor, ...]:
    """Return the factors of a position, the smallest first.

    Args:
        structure: The robot's structure.
        lines: Its joint lines at the position, in the tool frame.
        task: What the controller solves for.
        tool_direction: (3,) tool direction in the tool frame.
    """
    form = structure.form
    if isinstance(form, ArmForm):
        found = list(_arm_factors(form, lines, structure.length))
    elif isinstance(form, CartesianForm):
        found = list(_cartesian_factors(form, lines, task, tool_direction))
    elif isinstance(form, WristForm):
        found = [_wrist_factor(form.joints, lines)]
    else:
        found = []
    return tuple(sorted(found, key=lambda factor: factor.value))


def _arm_factors(arm: ArmForm, lines: Lines, length: float) -> Iterator[Factor]:
    a2 = lines.directions[arm.upper]
    if arm.wrist is not None:
        yield _wrist_factor(arm.wrist, lines)
    upper = lines.points[arm.elbow] - lines.points[arm.upper]
    fore = nearest_point_to_lines(lines, arm.tip) - lines.points[arm.elbow]
    upper, fore = upper - a2 * (upper @ a2), fore - a2 * (fore @ a2)
    size = float(np.linalg.norm(upper) * np.linalg.norm(fore))
    if size > _ZERO_ARM**2:
        sine = float(a2 @ np.cross(upper, fore)) / size
        yield Factor("elbow", sine, (arm.upper, arm.elbow), folded=bool(upper @ fore < 0.0))
    if arm.turn is not None:
        a1 = lines.directions[arm.turn]
        arm_to_head = nearest_point_to_lines(lines, arm.head) - lines.points[arm.turn]
        distance = float(a2 @ np.cross(a1, arm_to_head))
        offset = abs(float(a2 @ arm_to_head))
        yield Factor("shoulder", distance / length, (arm.turn, *arm.head[:1]), offset=offset, distance=abs(distance))


def _wrist_factor(joints: tuple[int, int, int], lines: Lines) -> Factor:
    return Factor("wrist", coplanar(*(lines.directions[n] for n in joints)), joints)


def coplanar(first: Vector, middle: Vector, last: Vector) -> float:
    """Return the sine of the turn about the middle direction (3,) at which the three lie in a plane; signed.

    0 where two of them are parallel whatever that turn is.
    """
    before, behind = np.cross(first, middle), np.cross(middle, last)
    size = float(np.linalg.norm(before) * np.linalg.norm(behind))
    return float(first @ behind) / size if size > _PARALLEL else 0.0


def _cartesian_factors(mill: CartesianForm, lines: Lines, task: Task, d: Vector) -> Iterator[Factor]:
    directions = [lines.directions[n] for n in mill.rotary]
    if task == "direction" and len(mill.rotary) == 2:
        swings = [np.cross(c, d) for c in directions]
        sines = [float(np.linalg.norm(swing)) for swing in swings]
        pole = int(np.argmin(sines))
        yield Factor("pole", sines[pole], (mill.rotary[pole],))
        across = float(np.linalg.norm(np.cross(swings[0], swings[1])))
        # Both swings are across the tool: they are parallel where axes and tool lie in a plane.
        if min(sines) > 0.0:
            yield Factor("tilt_end", across / (sines[0] * sines[1]), mill.rotary)
    elif task == "pose" and len(mill.rotary) == 3:
        yield _wrist_factor((mill.rotary[0], mill.rotary[1], mill.rotary[2]), lines)
