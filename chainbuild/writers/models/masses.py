"""Masses that nobody has measured: those of bodies of one density, for simulators that must have some."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body, by_link
from chainbuild.chain.bodies.inertia import Inertia, lumped
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.collision.solids import Solid, solids_of
from chainbuild.meshes import Triangles

DENSITY: Final = 2700.0  # kg/m³: of aluminium, between hollow castings of iron and covers
# Of a link without bodies or mass: simulators divide by it.
MASSLESS: Final = Inertia(0.1, np.zeros(3), 1e-5 * np.eye(3))
_GRAVITY: Final = 9.81  # m/s²
_LEAST: Final = 1e-12  # kg and kg·m²: MuJoCo refuses 1e-15, and files of zeros have rounding beside them
_SMALL_M: Final = 0.01  # radius of gyration where moments are missing: no link is smaller
_DIGITS: Final = 6  # of estimates: their last bits differ between machines


def link_inertias(chain: Chain, bodies: Iterable[Body], density: float = DENSITY) -> dict[str, Inertia]:
    """Return the inertia of every link: those given, or estimates, rounded.

    Where a file gives any, links of which it gives none are left out: they have no mass there.

    Args:
        chain: The chain.
        bodies: What is drawn of it; bodies of the overlay count in their place.
        density: [kg/m³] of estimates.
    """
    if chain.geometry.inertias:
        return dict(chain.geometry.inertias)
    drawn = by_link(bodies)
    given = [link for link, shapes in chain.geometry.shapes.items() if shapes]
    solids = [solid for solid in solids_of(chain) if solid.link in given] if given else []
    return {
        link.name: _rounded(
            _together([_of_solid(solid, density) for solid in solids if solid.link == link.name])
            if link.name in given
            else estimated(drawn.get(link.name, ()), density)
        )
        for link in chain.links
    }


def holding_efforts(chain: Chain, inertias: Mapping[str, Inertia]) -> Vector:
    """Return an effort (n_q,) that holds what a joint carries in any position [N·m, N].

    It is a bound: all masses beyond the joint with their arms outstretched, in closed loops those of the whole machine.
    """
    weights = {link: _GRAVITY * inertia.mass for link, inertia in inertias.items()}
    efforts, size = np.zeros(len(chain.joints)), machine_size(chain)
    if chain.loops:
        whole = sum(weights.values())
        return np.array([whole * (1.0 if joint.kind == "prismatic" else size) for joint in chain.joints])
    bounds = np.abs(chain.axis_map.q_bounds(*shown_limits(chain))).max(axis=0)
    carrier = {joint.child: n for n, joint in enumerate(chain.joints)}
    for link, inertia in inertias.items():
        place, arm = link, float(np.linalg.norm(inertia.centre))
        while place in carrier:
            n = carrier[place]
            joint = chain.joints[n]
            linear = joint.kind == "prismatic"
            efforts[n] += weights[link] * (1.0 if linear else arm)
            stroke = float(bounds[n]) if linear else 0.0
            arm += float(np.linalg.norm(joint.T_parent_joint[:3, 3])) + (stroke if math.isfinite(stroke) else size)
            place = joint.parent
    return efforts


def estimated(bodies: Iterable[Body], density: float = DENSITY) -> Inertia:
    """Return the inertia of a link whose bodies are solid; where they overlap both count.

    Args:
        bodies: The link's bodies.
        density: [kg/m³].
    """
    return _together([_part(body, density) for body in bodies])


def _together(parts: Sequence[Inertia]) -> Inertia:
    """Return the inertia of several bodies of one link, or a bare one where there are none."""
    return lumped(parts) if sum(part.mass for part in parts) > 0.0 else MASSLESS


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
    return Inertia(mass, np.zeros(3), np.diag(own)).seen_from(body.T_link_body)


def _of_mesh(body: Body, surface: Triangles, density: float) -> Inertia:
    """Return the inertia of what a mesh encloses, by the tetrahedra of its triangles and a point; open: of its box."""
    a, b, c = (surface.points[surface.corners[:, n]] for n in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    volume = float(volumes.sum())
    if not surface.closed or not 0.0 < volume <= math.prod(body.dimensions):
        return _part(replace(body, kind="box", surface=None), density)
    total = a + b + c
    centre = np.einsum("i,ij->j", volumes, total) / (4.0 * volume)
    second = sum(np.einsum("i,ij,ik->jk", volumes, one, one) for one in (a, b, c, total)) / 20.0
    second = density * (second - volume * np.outer(centre, centre))
    return Inertia(density * volume, centre, np.trace(second) * np.eye(3) - second).seen_from(body.T_link_body)


def _of_solid(solid: Solid, density: float) -> Inertia:
    """Return the inertia of one body of the overlay; a mesh counts as its hull, for it need not be closed.

    What encloses nothing, like a flat mesh, weighs nothing.
    """
    geometry = solid.around
    volume = float(geometry.computeVolume())
    if not volume > 0.0:
        return Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
    centre, moments = np.asarray(geometry.computeCOM()), np.asarray(geometry.computeMomentofInertiaRelatedToCOM())
    return Inertia(density * volume, centre.ravel(), density * moments).seen_from(solid.T_link_solid)


def turnable(inertia: Inertia) -> Inertia:
    """Return an inertia by which a simulator can divide: that of a small body where a file gives none that resists."""
    if inertia.mass < _LEAST:
        return MASSLESS
    least = float(np.linalg.eigvalsh(inertia.moments)[0])
    if least > _LEAST:
        return inertia
    return replace(inertia, moments=inertia.moments + (inertia.mass * _SMALL_M**2 - least) * np.eye(3))


def _rounded(inertia: Inertia) -> Inertia:
    """Return an estimate without the last bits, which differ between machines."""
    places = _DIGITS - 1 - math.floor(math.log10(float(np.diag(inertia.moments).max())))
    mass = float(f"{inertia.mass:.{_DIGITS}g}")
    return Inertia(mass, inertia.centre.round(_DIGITS), inertia.moments.round(places))
