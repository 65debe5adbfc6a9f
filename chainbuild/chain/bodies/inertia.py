"""Masses of links and the dynamics of joints, as far as a file gives them. Frozen data, no maths."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from chainbuild.arrays import Matrix, Vector
from chainbuild.shown import fields_shown


@dataclass(frozen=True, slots=True, eq=False)
class Inertia:
    """The inertia of a link.

    Attributes:
        mass: [kg].
        centre: (3,) centre of mass in the link [m].
        moments: (3, 3) about the centre, in the link's axes [kg·m²].
    """

    __repr__ = fields_shown

    mass: float
    centre: Vector
    moments: Matrix


@dataclass(frozen=True, slots=True)
class JointDynamics:
    """What a file says of a joint beside its place and its range.

    Attributes:
        effort: Largest torque [N·m] or force [N]; None: not given.
        damping: [N·m·s/rad] or [N·s/m].
        friction: Static friction [N·m] or [N].
    """

    __repr__ = fields_shown

    effort: float | None = None
    damping: float = 0.0
    friction: float = 0.0


NO_DYNAMICS: Final = JointDynamics()  # of machine data: controllers do not ask for these
