"""Vectors of three as plain numbers: arrays of three cost more than what they hold."""

from __future__ import annotations

import math

PlainVector = tuple[float, float, float]


def plain_dot(a: PlainVector, b: PlainVector) -> float:
    """Return a·b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plain_cross(a: PlainVector, b: PlainVector) -> PlainVector:
    """Return a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def plain_length(a: PlainVector) -> float:
    """Return |a|."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def plain_turned(k: PlainVector, angle: float, p: PlainVector) -> PlainVector:
    """Return Rot(k, angle)·p by Rodrigues' formula."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = plain_cross(k, p)
    along = (1.0 - c) * plain_dot(k, p)
    return c * p[0] + s * x + along * k[0], c * p[1] + s * y + along * k[1], c * p[2] + s * z + along * k[2]


def across_axis(k: PlainVector, p: PlainVector) -> tuple[float, PlainVector]:
    """Return a vector's height along an axis, and the rest."""
    height = plain_dot(k, p)
    return height, (p[0] - height * k[0], p[1] - height * k[1], p[2] - height * k[2])
