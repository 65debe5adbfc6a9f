"""The picture of a path: dips between rows, gaps, shaded stretches."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from chainbuild import Robot, path_report
from chainbuild.analysis.path.dips import dips_of
from chainbuild.analysis.singularity.measures import smallest_value
from chainbuild.writers.pathpicture import path_picture

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot.load("kr6r900")


def drawn(arm: Robot, rows: np.ndarray) -> ET.Element:
    report = path_report(arm, rows)
    return ET.fromstring(path_picture(report, dips_of(arm, list(rows), report), "a path", 0.05))


def test_dips_are_the_values_between_the_rows(arm: Robot) -> None:
    rows = np.array([[0, -90, 90, 10, a5, 0] for a5 in (20.0, 8.0, -8.0, -20.0)])
    report = path_report(arm, rows)
    dips = dips_of(arm, list(rows), report)
    assert (np.diff(dips[:, 0]) >= 0.0).all()
    assert dips[0, 0] == pytest.approx(report.stretches[0].begin.row + report.stretches[0].begin.share)
    assert dips[:, 1].min() < 1e-9  # the minimum itself, between two samples
    for at, value in dips[::20]:
        axes = [np.interp(at, range(4), column) for column in rows.T]
        assert value == pytest.approx(smallest_value(arm, axes), abs=1e-9)


def test_the_line_is_open_at_gaps(arm: Robot) -> None:
    rows = np.array([[0, -90, 90, 10, a5, 0] for a5 in (30.0, 25.0, np.nan, 20.0, 15.0)])
    rows[2] = np.nan
    root = drawn(arm, rows)
    lines = [line for line in root.iter(f"{SVG}polyline") if line.get("stroke-dasharray") is None]
    ends = [[float(point.split(",")[0]) for point in line.get("points", "").split()] for line in lines]
    # The frame is 560 wide from 70 on, the rows 1 … 5 over it.
    assert [(part[0], part[-1]) for part in ends] == [(70.0, 210.0), (490.0, 630.0)]
    (grey,) = [box for box in root.iter(f"{SVG}rect") if box.get("opacity") == "0.18"]
    assert (float(grey.get("x", "")), float(grey.get("width", ""))) == (210.0, 280.0)


def test_stretches_are_shaded_where_they_are(arm: Robot) -> None:
    rows = np.array([[0, -90, 90, 10, -8, 0], [0, -90, 90, 10, 8, 0], [0, -90, 90, 10, 40, 0]], dtype=float)
    root = drawn(arm, rows)
    report = path_report(arm, rows)
    (stretch,) = report.stretches
    (box,) = [box for box in root.iter(f"{SVG}rect") if box.get("opacity") == "0.18"]
    assert float(box.get("x", "")) == pytest.approx(70.0 + 280.0 * stretch.begin.share, abs=0.01)
    assert float(box.get("width", "")) == pytest.approx(280.0 * (stretch.end.share - stretch.begin.share), abs=0.02)
    assert len(list(root.iter(f"{SVG}circle"))) == 1
