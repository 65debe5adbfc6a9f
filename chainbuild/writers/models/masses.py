"""Masses that nobody has measured: those of drawn bodies of one density, for simulators that must have some."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.inertia import Inertia

DENSITY: Final = 2700.0  # kg/m³: of aluminium, between hollow castings of iron and covers
_BARE: Final = (0.1, 1e-5)  # kg and kg·m² of a link without bodies: simulators divide by them


def estimated(bodies: Iterable[Body], density: float = DENSITY) -> Inertia:
    """Return the inertia of a link whose bodies are solid; where they overlap both count.

    Args:
        bodies: The link's bodies.
        density: [kg/m³].
    """
    parts = [_part(body, density) for body in bodies]
    mass = sum(part.mass for part in parts)
    if mass <= 0.0:
        return Inertia(_BARE[0], np.zeros(3), _BARE[1] * np.eye(3))
    centre: Vector = np.sum([part.mass * part.centre for part in parts], axis=0) / mass
    moments = np.zeros((3, 3))
    for part in parts:
        away = part.centre - centre
        moments += part.moments + part.mass * (away @ away * np.eye(3) - np.outer(away, away))
    return Inertia(mass, centre, moments)


def _part(body: Body, density: float) -> Inertia:
    """Return the inertia of one body in its link."""
    if body.kind == "box":
        x, y, z = body.dimensions
        mass = density * x * y * z
        own = mass / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    elif body.kind == "sphere":
        [radius] = body.dimensions
        mass = density * 4.0 / 3.0 * math.pi * radius**3
        own = np.full(3, 0.4 * mass * radius**2)
    else:
        radius, length = body.dimensions
        mass = density * math.pi * radius**2 * length
        across = mass * (3.0 * radius**2 + length**2) / 12.0
        own = np.array([across, across, mass * radius**2 / 2.0])
    R = body.T_link_body[:3, :3]
    return Inertia(mass, body.T_link_body[:3, 3], R @ np.diag(own) @ R.T)
