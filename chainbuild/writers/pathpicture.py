"""The picture of a path: the smallest singular value over its rows, and between them where it is small."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.writers.chart import Chart

if TYPE_CHECKING:
    from chainbuild.analysis.path.places import PathReport

_BLUE, _ORANGE, _RED, _GREY = "#1f6feb", "#bc4c00", "#cf222e", "#57606a"
_LABELLED: Final = 12  # stretches named: more would stand on one another
_LINES: Final = 3  # on which names of neighbours stand: on one they would cover one another
_HEADROOM: Final = 1.05  # of the largest value: the line does not touch the frame


def path_picture(report: PathReport, dips: Matrix, title: str, threshold: float) -> str:
    """Return the smallest singular value along a path as SVG.

    Stretches close to singularities are shaded, their minima marked (filled: singular), gaps left open.

    Args:
        report: The report on the path.
        dips: (n, 2) places between rows, row and share from 0, and values; see `dips_of`.
        title: Heading.
        threshold: Of the smallest singular value.
    """
    stretches = [one for one in report.stretches if not one.of_vector]
    values = report.smallest[np.isfinite(report.smallest)]
    top = max(float(values.max(initial=0.0)), float(dips[:, 1].max(initial=0.0)), threshold) * _HEADROOM
    ends = (1.0, float(max(report.rows, 1)))
    chart = Chart(title, "row", "smallest singular value, scaled", ends, (0.0, top))
    for n, stretch in enumerate(stretches):
        begin, end = (1.0 + place.row + place.share for place in (stretch.begin, stretch.end))
        words = stretch.kind if stretch.proven else f"{stretch.kind}, sampled"
        chart.stretch(begin, end, _ORANGE, words if n < _LABELLED else "", n % _LINES)
    for row in report.gaps:
        chart.stretch(max(float(row), 1.0), min(row + 2.0, ends[1]), _GREY)
    chart.line(ends, (threshold, threshold), _ORANGE, dashed=True)
    for run in _runs(report, dips):
        chart.line((run[:, 0] + 1.0).tolist(), run[:, 1].tolist(), _BLUE)
    for stretch in stretches:
        for minimum in stretch.minima:
            if not np.isnan(minimum.smallest):
                place = 1.0 + minimum.place.row + minimum.place.share
                chart.mark(place, minimum.smallest, _RED, filled=minimum.singular)
    return chart.text()


def _runs(report: PathReport, dips: Matrix) -> list[Matrix]:
    """Return places and values, rows and what lies between them, in runs without gaps."""
    rows = np.stack([np.arange(report.rows, dtype=float), report.smallest], axis=1)
    known = rows[np.isfinite(rows[:, 1])]
    points = np.concatenate([known, dips])
    points = points[np.lexsort((np.arange(len(points)), points[:, 0]))]
    cuts = np.searchsorted(points[:, 0], np.array(report.gaps, dtype=float))
    return [run for run in np.split(points, cuts) if len(run)]
