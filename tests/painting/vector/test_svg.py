"""The SVG: the same bytes whatever the processor, small, with what a reader can check by hand."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import Robot
from chainbuild.painting.marks import Caption, Marks, Stroke
from chainbuild.painting.stage import PlacedBody, Stage, framed, snapped
from chainbuild.painting.vector.svg import Sheet, path_data
from chainbuild.painting.views import VIEWS, Window
from tests.kit.placed import placed

SVG = "{http://www.w3.org/2000/svg}"
MACHINES = ("ac_table_kin58", "irb2600_track")

HASHES = """
import hashlib, sys
import chainbuild
robot = chainbuild.Robot.load(sys.argv[1])
lengths = chainbuild.dimensions(chainbuild.load(sys.argv[1]))
for suffix in ("svg", "png"):
    path = chainbuild.picture(robot, f"x.{suffix}", frames=True, dimensions=lengths)
    print(hashlib.sha256(path.read_bytes()).hexdigest())
"""


def svg_of(bodies: list[PlacedBody], window: Window, view: str = "iso") -> str:
    sheet = Sheet(window.width, window.height)
    sheet.paint(bodies, VIEWS[view], window)  # type: ignore[index]
    return sheet.text()


def test_a_box_from_the_front_is_a_rectangle() -> None:
    box = placed("box", (0.2, 0.3, 0.1), (0, 0, 0))
    root = ET.fromstring(svg_of([box], Window(-0.5, 0.4, 100.0, 100, 80), "front"))
    paths = [path.get("d") for path in root.iter(f"{SVG}path")]
    assert paths == ["M400 350l0 100 200 0 0-100z", "M400 350l0 100 200 0 0-100z"]  # its face, and its outline
    ink = [path.get("fill") for path in root.iter(f"{SVG}path")]
    # 0.5 · (0.8 + 0.32 · 0.57): light on a face that is seen straight.
    assert ink == ["#7d7d7d", "none"]


def test_paths_are_short_and_say_the_same() -> None:
    assert path_data([(1.04, 2.0), (1.26, 2.0), (1.26, 0.0)]) == "M10 20l3 0 0-20"
    assert path_data([(0.0, 0.0), (0.02, 0.01)]) == ""
    assert path_data([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)]) == "M0 0l10 0 0 10z"


def test_round_bodies_have_gradients() -> None:
    bodies = [placed("cylinder", (0.1, 0.4), (0, 0, 0)), placed("sphere", (0.1,), (0.5, 0, 0))]
    root = ET.fromstring(svg_of(bodies, framed(bodies, VIEWS["iso"], 400, 300)))
    gradients = [*root.iter(f"{SVG}linearGradient"), *root.iter(f"{SVG}radialGradient")]
    used = {path.get("fill") for path in root.iter(f"{SVG}path")}
    assert {f"url(#{one.get('id')})" for one in gradients} <= used
    across, around = gradients
    # Light from the left: the left border of the cylinder is brighter than the right one.
    stops = [int(stop.get("stop-color", "")[1:3], 16) for stop in across]
    assert float(across.get("x1", "")) > float(across.get("x2", ""))
    assert stops[0] < stops[-1]
    stops = [int(stop.get("stop-color", "")[1:3], 16) for stop in around]
    assert stops == sorted(stops, reverse=True)


def test_gradients_are_those_of_the_light() -> None:
    window = Window(-1.0, 1.0, 100.0, 200, 200)
    bodies = [placed("cylinder", (0.2, 0.4), (0, 0, 0)), placed("sphere", (0.3,), (0.6, 0, 0.5))]
    root = ET.fromstring(svg_of(bodies, window, "front"))
    (across,) = root.iter(f"{SVG}linearGradient")
    assert [across.get(key) for key in ("x1", "y1", "x2", "y2")] == ["1200", "1000", "800", "1000"]
    stops = [(stop.get("offset"), stop.get("stop-color")) for stop in across]
    # 0.5 · (0.8 + 0.32 · light) at the right border, in the middle, at the left border.
    assert [stops[0], stops[2], stops[4]] == [("0", "#575757"), ("0.5", "#7d7d7d"), ("1", "#757575")]
    assert len(stops) == 5
    (around,) = root.iter(f"{SVG}radialGradient")
    # Brightest 0.36 of the radius to the left of the middle and 0.74 above it.
    assert [around.get(key) for key in ("cx", "cy", "r")] == ["1492", "278", "547"]
    stops = [(stop.get("offset"), stop.get("stop-color")) for stop in around]
    assert (len(stops), stops[0], stops[2], stops[4]) == (5, ("0", "#8f8f8f"), ("0.5", "#7a7a7a"), ("1", "#444444"))


def test_lines_and_texts_over_the_bodies() -> None:
    sheet = Sheet(100, 80)
    sheet.mark(
        Marks([Stroke(((1.0, 2.0), (3.0, 2.0)), (1.0, 0.0, 0.0), 1.5, halo=True)], [Caption("a < b", 50.0, 40.0)])
    )
    root = ET.fromstring(sheet.text())
    halo, line = root.iter(f"{SVG}path")
    assert (halo.get("d"), halo.get("stroke-width")) == ("M10 20l20 0", "55")  # two pixels on each side
    assert (line.get("stroke"), line.get("stroke-width")) == ("#ff0000", "15")
    (text,) = root.iter(f"{SVG}text")
    assert [text.get(key) for key in ("x", "y", "font-size")] == ["500", "400", "130"]
    assert text.text == "a < b"


@pytest.mark.parametrize("name", MACHINES)
def test_a_nudge_changes_nothing(name: str) -> None:
    bodies = Stage(Robot.load(name)).bodies
    window = framed(bodies, VIEWS["iso"], 960, 720)
    text = svg_of(list(bodies), window)
    rng = np.random.default_rng(2)
    nudged = []
    for body in bodies:
        T = body.T.copy()
        T[:3] += rng.uniform(-1e-14, 1e-14, (3, 4))
        nudged.append(replace(body, T=snapped(T)))
    assert svg_of(nudged, framed(nudged, VIEWS["iso"], 960, 720)) == text
    assert 5_000 < len(text) < 30_000


@pytest.mark.parametrize("name", MACHINES)
def test_every_body_with_pixels_has_a_path(name: str) -> None:
    bodies = list(Stage(Robot.load(name)).bodies)
    root = ET.fromstring(svg_of(bodies, framed(bodies, VIEWS["iso"], 960, 720)))
    assert len(list(root.iter(f"{SVG}path"))) >= len(bodies) / 2


def test_the_same_bytes_on_every_processor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernels of the library of linear algebra differ between processors; the bytes do not."""
    monkeypatch.chdir(tmp_path)
    environment = {**os.environ, "PYTHONPATH": str(Path(chainbuild.__file__).parent.parent)}
    environment["OPENBLAS_CORETYPE"] = "Nehalem"
    done = subprocess.run(
        [sys.executable, "-c", HASHES, "irb2600_table"], env=environment, capture_output=True, text=True, check=True
    )
    robot, lengths = Robot.load("irb2600_table"), chainbuild.dimensions(chainbuild.load("irb2600_table"))
    for suffix, there in zip(("svg", "png"), done.stdout.split(), strict=True):
        path = chainbuild.picture(robot, f"x.{suffix}", frames=True, dimensions=lengths)
        assert hashlib.sha256(path.read_bytes()).hexdigest() == there
