"""Pictures of analyses as SVG: maps, free intervals, measures along a path."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Vector
from chainbuild.files import write_text
from chainbuild.writers.chart import Chart

if TYPE_CHECKING:
    from chainbuild.analysis.collision.sweep import FreeInterval
    from chainbuild.analysis.workspace.maps import Map


# From singular to well-conditioned: dark to bright, readable without colours.
_SCALE: Final = np.array([[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], dtype=float)
_STEPS: Final = 24  # colours of the legend: it looks like a ramp
_BLUE, _ORANGE = "#1f6feb", "#bc4c00"


def write_picture(path: Path, svg: str) -> Path:
    """Write an SVG file and return its path.

    Raises:
        FileAccessError: the file cannot be written.
    """
    write_text(path, svg)
    return path


def map_picture(shown: Map, title: str) -> str:
    """Return a map as SVG; a volume is seen along its y axis, the best cell in front."""
    labels, edges, values = shown.grid.labels, shown.grid.edges, shown.smallest
    if values.ndim == 3:
        covered = np.where(np.isnan(values), -1.0, values).max(axis=1)
        values = np.where(covered < 0.0, np.nan, covered)
        labels, edges = (labels[0], labels[2]), (edges[0], edges[2])
    x, y = ((float(edge[0]), float(edge[-1])) for edge in edges)
    chart = Chart(title, labels[0], labels[1], x, y, square=shown.spec.kind != "axes")
    known = values[np.isfinite(values)]
    top = float(known.max()) if known.size else 1.0
    chart.image(_pixels(values.T[::-1] / (top or 1.0)))
    ends = np.linspace(0.0, 1.0, _STEPS)
    colours = [f"#{''.join(f'{int(part):02x}' for part in _colour(np.array(end)))}" for end in ends]
    chart.legend(colours, "0", f"{top:.2g}", "smallest singular value, scaled")
    return chart.text()


def _colour(share: Vector) -> Vector:
    """Return colours (…, 3) in 0…255 of shares in 0…1."""
    place = np.clip(share, 0.0, 1.0) * (len(_SCALE) - 1)
    low = np.minimum(place.astype(int), len(_SCALE) - 2)
    part = (place - low)[..., None]
    mixed: Vector = _SCALE[low] * (1.0 - part) + _SCALE[low + 1] * part
    return mixed.round()


def _pixels(shares: Vector) -> NDArray[np.uint8]:
    empty = np.isnan(shares)
    pixels = np.zeros((*shares.shape, 4), dtype=np.uint8)
    pixels[..., :3] = _colour(np.where(empty, 0.0, shares)).astype(np.uint8)
    pixels[..., 3] = np.where(empty, 0, 255)
    return pixels


def interval_picture(
    intervals: Sequence[FreeInterval],
    title: str,
    x_label: str,
    y_label: str,
    marks: Sequence[float] = (),
) -> str:
    """Return free intervals over an axis as SVG, with dashed lines at given values."""
    free = [(i.over, i.lower, i.upper) for i in intervals if i.lower is not None and i.upper is not None]
    values = [value for _, low, high in free for value in (low, high)] + list(marks) or [0.0, 1.0]
    margin = 0.05 * (max(values) - min(values))
    x = (intervals[0].over, intervals[-1].over) if intervals else (0.0, 1.0)
    chart = Chart(title, x_label, y_label, x, (min(values) - margin, max(values) + margin))
    for run in _runs(intervals):
        over = [i.over for i in run]
        low, high = [i.lower or 0.0 for i in run], [i.upper or 0.0 for i in run]
        chart.band(over, low, high, _BLUE)
        chart.line(over, low, _BLUE)
        chart.line(over, high, _BLUE)
    for mark in marks:
        chart.line(x, (mark, mark), _ORANGE, dashed=True)
    return chart.text()


def _runs(intervals: Sequence[FreeInterval]) -> list[list[FreeInterval]]:
    """Return the intervals in runs without gaps."""
    runs: list[list[FreeInterval]] = [[]]
    for interval in intervals:
        if interval.lower is None:
            runs.append([])
        else:
            runs[-1].append(interval)
    return [run for run in runs if run]


def measure_picture(smallest: Vector, title: str, threshold: float) -> str:
    """Return the smallest singular value along the rows of a path as SVG."""
    known = np.flatnonzero(~np.isnan(smallest))  # the others have no pose
    rows = (known + 1).tolist()
    top = max(float(smallest[known].max(initial=0.0)), threshold) * 1.05
    chart = Chart(title, "row", "smallest singular value, scaled", (1.0, float(len(smallest))), (0.0, top))
    chart.line(rows, smallest[known].tolist(), _BLUE)
    chart.line((1.0, float(len(smallest))), (threshold, threshold), _ORANGE, dashed=True)
    return chart.text()


def distance_picture(distances: Vector, title: str) -> str:
    """Return the smallest distance (N,) [m] of bodies along the rows of a path as SVG; NaN if none is checked."""
    shown = np.where(np.isfinite(distances), distances, 0.0) * 1000.0
    rows = list(range(1, len(shown) + 1))
    low, high = min(float(shown.min()), 0.0), max(float(shown.max()), 0.0)
    chart = Chart(title, "row", "smallest distance [mm]", (1.0, float(max(rows))), (low, high))
    chart.line(rows, shown.tolist(), _BLUE)
    chart.line((1.0, float(max(rows))), (0.0, 0.0), _ORANGE, dashed=True)
    return chart.text()
