"""Drawn bodies as solids: whether they touch, overlap, and how far they reach."""

from __future__ import annotations

from collections.abc import Sequence

import coal
import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.elements import Chain
from chainbuild.chain.poses import link_placements


def shape(body: Body) -> coal.ShapeBase:
    """Return the solid of a body."""
    if body.kind == "box":
        return coal.Box(*body.dimensions)
    return coal.Cylinder(*body.dimensions) if body.kind == "cylinder" else coal.Sphere(*body.dimensions)


def placed(chain: Chain, axes: Vector, bodies: Sequence[Body]) -> list[coal.CollisionObject]:
    """Return the solids of bodies at axis values (n_axes,), in their order."""
    links = link_placements(chain, chain.axis_map.q(axes))
    objects = []
    for body in bodies:
        T = links[body.link] @ body.T_link_body
        objects.append(coal.CollisionObject(shape(body), coal.Transform3s(T[:3, :3], T[:3, 3])))
    return objects


def depth(a: coal.CollisionObject, b: coal.CollisionObject) -> float:
    """Return how deep two solids overlap [m]."""
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    if not coal.collide(a, b, request, result):
        return 0.0
    return abs(float(result.getContact(0).penetration_depth))


def gap(a: coal.CollisionObject, b: coal.CollisionObject) -> float:
    """Return how far two solids are apart [m], below zero where they overlap."""
    return float(coal.distance(a, b, coal.DistanceRequest(), coal.DistanceResult()))


def overlap(a: coal.CollisionObject, b: coal.CollisionObject, margin: float) -> bool:
    """Return whether the boxes around two bodies come closer than a margin, to save the exact question."""
    for one in (a, b):
        one.computeAABB()
    low, high = a.getAABB(), b.getAABB()
    return bool(np.all(low.min_ <= high.max_ + margin) and np.all(high.min_ <= low.max_ + margin))


def span(thing: coal.CollisionObject, d: Vector) -> tuple[float, float]:
    """Return the extent [m] of an upright box along a direction of the site."""
    thing.computeAABB()
    ends = sorted((float(thing.getAABB().min_ @ d), float(thing.getAABB().max_ @ d)))
    return ends[0], ends[1]
