"""Planar geometry by hand: distances of segments and the free angles of a parallelogram. NumPy and math only."""

from __future__ import annotations

import math

import numpy as np


def segment_distance(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> float:
    """Distance between the segments ab and cd, in any dimension: minimum of a convex quadratic over the unit square."""
    u, v, w = b - a, d - c, a - c
    best = math.inf
    uu, vv, uv = u @ u, v @ v, u @ v
    det = uu * vv - uv * uv
    if det > 1e-14 * uu * vv:
        s = (uv * (v @ w) - vv * (u @ w)) / det
        t = (uu * (v @ w) - uv * (u @ w)) / det
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            best = float(np.linalg.norm(w + s * u - t * v))
    for point, start, way in ((a, c, v), (b, c, v), (c, a, u), (d, a, u)):
        length = way @ way
        share = min(max((point - start) @ way / length, 0.0), 1.0) if length > 0.0 else 0.0
        best = min(best, float(np.linalg.norm(point - start - share * way)))
    return best


def turned(vector: tuple[float, float], degrees: float) -> np.ndarray:
    """A vector (x, z) turned about +y, as the joints of the arm turn."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([c * vector[0] + s * vector[1], -s * vector[0] + c * vector[1]])


def edge(collides, free: float, hit: float) -> float:
    """The border between a free and a colliding value, by bisection to 1e-6."""
    while abs(hit - free) > 1e-6:
        middle = (free + hit) / 2.0
        free, hit = (free, middle) if collides(middle) else (middle, hit)
    return free
