"""Masses of links and the dynamics of joints, as far as a file gives them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

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

    def seen_from(self, T: Matrix) -> Inertia:
        """Return the same inertia in the axes of another link, in which its own stands at T (4, 4) [m]."""
        R = T[:3, :3]
        turned = R @ self.moments @ R.T
        return Inertia(self.mass, R @ self.centre + T[:3, 3], (turned + turned.T) / 2.0)


def lumped(parts: Sequence[Inertia]) -> Inertia:
    """Return the inertia of rigidly joined parts, all in the axes of one link.

    Moments are taken to the common centre (Huygens-Steiner); parts without mass add theirs as they are.

    Args:
        parts: At least one.
    """
    if len(parts) == 1:
        return parts[0]
    mass = sum(part.mass for part in parts)
    centre = sum((part.mass * part.centre for part in parts), np.zeros(3)) / mass if mass else parts[0].centre
    moments = np.zeros((3, 3))
    for part in parts:
        arm = part.centre - centre
        across = (arm @ arm) * np.eye(3) - np.outer(arm, arm)
        moments += part.moments + part.mass * across
    return Inertia(mass, centre, moments)


def joined_inertias(
    host: Mapping[str, Inertia], guest: Mapping[str, Inertia], names: Mapping[str, str], places: Mapping[str, Matrix]
) -> dict[str, Inertia]:
    """Return the inertias of the links of two chains that become one.

    Args:
        host: Link → inertia of the chain that is grafted on.
        guest: The same of the other.
        names: The guest's links → their names in both; its root is a link of the host.
        places: The guest's links whose axes are others now → (4, 4) the old ones in the new [m].
    """
    parts = {link: [one] for link, one in host.items()}
    for link, one in guest.items():
        parts.setdefault(names[link], []).append(one.seen_from(places[link]) if link in places else one)
    return {link: lumped(found) for link, found in parts.items()}


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
