"""Masses that nobody has measured: those of drawn bodies of one density, for simulators that must have some."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.inertia import Inertia
from chainbuild.meshes import Triangles

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
    if body.surface is not None:
        return _of_mesh(body, body.surface, density)
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


def _of_mesh(body: Body, surface: Triangles, density: float) -> Inertia:
    """Return the inertia of what a mesh encloses, by the tetrahedra of its triangles and a point; open: of its box."""
    a, b, c = (surface.points[surface.corners[:, n]] for n in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    volume = float(volumes.sum())
    if not 0.0 < volume <= math.prod(body.dimensions):
        return _part(replace(body, kind="box", surface=None), density)
    total = a + b + c
    centre = np.einsum("i,ij->j", volumes, total) / (4.0 * volume)
    second = sum(np.einsum("i,ij,ik->jk", volumes, one, one) for one in (a, b, c, total)) / 20.0
    second = density * (second - volume * np.outer(centre, centre))
    T = body.T_link_body
    moments = T[:3, :3] @ (np.trace(second) * np.eye(3) - second) @ T[:3, :3].T
    return Inertia(density * volume, T[:3, :3] @ centre + T[:3, 3], moments)
