"""The overlay's table [geometry]: what it gives, and how it is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.bodies.shapes import link_bodies
from chainbuild.errors import OverlayError
from chainbuild.formats.overlay import read_overlay

FULL = """
[geometry]
ignore = [["base", "B3_link"]]

[geometry.radii_mm]
B1_link = 75

[geometry.shapes]
B2_link = [
    {capsule = [0, 0, 0, 400, 0, 0], radius_mm = 60},
    {box = [100, 80, 60], at = [10, 20, 30, 90, 0, 0]},
]
A1_link = [{hull = "link4.stl", scale = 1.0}, {mesh = "link4.stl", at = [0, 0, 0, 0, 0, 90]}]
base = [{sphere = [0, 0, 100], radius_mm = 150}, {cylinder = [0, 0, 0, 0, 0, 300], radius_mm = 120}]
"""


def overlay(folder: Path, text: str) -> Path:
    path = folder / "arm.chainbuild.toml"
    path.write_text(text, "utf-8")
    return path


def test_every_kind_of_body_in_metres(tmp_path: Path) -> None:
    geometry = read_overlay(overlay(tmp_path, FULL)).geometry
    assert geometry.radii == {"B1_link": pytest.approx(0.075)}
    capsule, box = geometry.shapes["B2_link"]
    assert (capsule.kind, capsule.points, capsule.radius) == ("capsule", (0, 0, 0, 0.4, 0, 0), 0.06)
    assert (box.kind, box.size) == ("box", (0.1, 0.08, 0.06))
    np.testing.assert_allclose(box.place, (0.01, 0.02, 0.03, 90.0, 0.0, 0.0))
    hull, mesh = geometry.shapes["A1_link"]
    assert (hull.kind, hull.file, hull.scale) == ("hull", tmp_path / "link4.stl", (1.0,) * 3)
    assert (mesh.kind, mesh.scale) == ("mesh", (0.001,) * 3)
    assert geometry.ignore == (("base", "B3_link"),)
    assert not geometry.rods


def test_radii_reach_the_drawn_bodies(tmp_path: Path) -> None:
    path = overlay(tmp_path, "[geometry.radii_mm]\nB1_link = 75\n")
    chain = chainbuild.load("kr6r900_2", overlay=path).chain()
    body = next(body for body in link_bodies(chain) if body.link == "B1_link")
    assert body.dimensions[0] == pytest.approx(0.075)
    assert chain.geometry.radii == {"B1_link": pytest.approx(0.075)}


@pytest.mark.parametrize(
    ("text", "parameter", "permitted"),
    [
        ("geometry = 3", "geometry", "a table"),
        ("[geometry]\nradius = 3", "radius", "radii_mm, shapes, rods"),
        ("[geometry]\nrods = 1", "rods", "true or false"),
        ("[geometry]\ncrank_mm = 0", "crank_mm", "above 0"),
        ("[geometry]\ncrank_angle_deg = true", "crank_angle_deg", "finite number"),
        ("[geometry]\nstyle = 'tower'", "style", "portal, column"),
        ("[geometry]\nstyle = 1", "style", "portal, column"),
        ("[geometry]\ncolumn = 'y'", "column", "+x, -x, +y, -y"),
        ("[geometry]\ntable_mm = 0", "table_mm", "above 0"),
        ("[geometry]\ntable_mm = nan", "table_mm", "finite number"),
        ("[geometry]\npart_mm = [1, 2]", "part_mm", "a list of 3 numbers"),
        ("[geometry]\npart_mm = [1, 2, -3]", "part_mm", "at least 0"),
        ("[geometry]\nignore = [['a']]", "ignore", "pairs of links"),
        ("[geometry]\nignore = 'a'", "ignore", "pairs of links"),
        ("[geometry]\nradii_mm = 5", "radii_mm", "[geometry.radii_mm]"),
        ("[geometry.radii_mm]\nbase = -5", "base", "above 0"),
        ("[geometry.shapes]\nbase = 5", "base", "a list of bodies"),
        ("[geometry.shapes]\nbase = [{cone = 5}]", "base", "capsule, cylinder, sphere, box, hull, mesh"),
        ("[geometry.shapes]\nbase = [{sphere = [0, 0], radius_mm = 5}]", "base", "a list of 3 numbers"),
        ("[geometry.shapes]\nbase = [{sphere = [0, 0, 0]}]", "base", "finite number"),
        ("[geometry.shapes]\nbase = [{sphere = [0, 0, 0], radius_mm = 5, colour = 1}]", "base", "not colour"),
        ("[geometry.shapes]\nbase = [{capsule = [1, 1, 1, 1, 1, 1], radius_mm = 5}]", "base", "different ends"),
        ("[geometry.shapes]\nbase = [{box = [1, 0, 1]}]", "base", "edges above 0"),
        ("[geometry.shapes]\nbase = [{hull = 5}]", "base", "the file name of a mesh"),
        ("[geometry.shapes]\nbase = [{mesh = 'a.stl', scale = 0}]", "base", "a scale above 0"),
    ],
)
def test_faults_name_key_line_and_what_is_permitted(tmp_path: Path, text: str, parameter: str, permitted: str) -> None:
    with pytest.raises(OverlayError) as caught:
        read_overlay(overlay(tmp_path, text))
    assert caught.value.parameter == parameter
    assert permitted in str(caught.value)
    assert caught.value.line


def test_links_that_do_not_exist_are_refused(tmp_path: Path) -> None:
    for text in ("[geometry.radii_mm]\nnose = 5", "[geometry]\nignore = [['base', 'nose']]"):
        with pytest.raises(OverlayError, match="no link 'nose'") as caught:
            chainbuild.load("kr6r900_2", overlay=overlay(tmp_path, text)).chain()
        assert "B2_link" in str(caught.value)
