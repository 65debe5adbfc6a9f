"""What an overlay says about the drawing of a machine."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.elements import Chain
from chainbuild.drawing.given import undrawn_meshes
from chainbuild.drawing.machine import drawn_bodies
from tests.kit.drawings import check_laws, home_and_middle, placements
from tests.kit.mesh_files import box, joined, write_stl


def chain_with(folder: Path, name: str, text: str) -> Chain:
    """Return a shipped machine with a table [geometry]."""
    path = folder / "own.chainbuild.toml"
    path.write_text(f"[geometry]\n{text}\n", "utf-8")
    return chainbuild.load(name, overlay=path).chain()


def centres(chain: Chain, part: str) -> list[np.ndarray]:
    """Return where the bodies of a kind have their middle at home, in the base."""
    bodies = [body for body in drawn_bodies(chain) if body.part == part]
    return [T[:3, 3] for T in placements(chain, bodies, home_and_middle(chain)[0])]


def parts(chain: Chain, part: str) -> list[Body]:
    return [body for body in drawn_bodies(chain) if body.part == part]


@pytest.mark.parametrize(("side", "axis", "sign"), [("+x", 0, 1), ("-x", 0, -1), ("+y", 1, 1), ("-y", 1, -1)])
def test_the_column_stands_on_the_side_named(tmp_path: Path, side: str, axis: int, sign: int) -> None:
    chain = chain_with(tmp_path, "bed_mill_kin1", f'column = "{side}"')
    (column,) = centres(chain, "column")
    assert sign * column[axis] > 0.3
    assert abs(column[1 - axis]) < 1e-9
    check_laws(chain)


@pytest.mark.parametrize(("name", "style", "posts", "columns"), [
    ("bed_mill_kin1", "portal", 2, 0), ("bed_mill_kin1", "column", 0, 1), ("ca_head_kin9", "portal", 2, 0),
    ("ca_head_kin9", "column", 0, 1), ("b_head_a_table_kin61", "column", 0, 1),
])  # fmt: skip
def test_the_style(tmp_path: Path, name: str, style: str, posts: int, columns: int) -> None:
    chain = chain_with(tmp_path, name, f'style = "{style}"')
    bearings = 2 if name == "b_head_a_table_kin61" else 0
    assert (len(parts(chain, "post")) - bearings, len(parts(chain, "column"))) == (posts, columns)
    check_laws(chain)


def test_the_plate_and_the_part_have_the_sizes_given(tmp_path: Path) -> None:
    chain = chain_with(tmp_path, "ac_table_kin58", "table_mm = 320\npart_mm = [60, 50, 40]")
    (plate,), (part,) = parts(chain, "table"), parts(chain, "workpiece")
    assert plate.dimensions[0] == pytest.approx(0.16)
    assert part.dimensions == pytest.approx((0.06, 0.05, 0.04))
    assert part.origin == "data"
    assert centres(chain, "workpiece")[0][2] == pytest.approx(-0.56 + 0.02)
    check_laws(chain)


def test_a_part_without_an_edge_is_none(tmp_path: Path) -> None:
    assert parts(chain_with(tmp_path, "ca_head_kin9", "part_mm = [60, 50, 0]"), "workpiece") == []


def test_the_bed_has_the_width_given(tmp_path: Path) -> None:
    bed = parts(chain_with(tmp_path, "ca_head_kin9", "table_mm = 800"), "pedestal")
    assert [body.dimensions[:2] for body in bed] == [pytest.approx((0.8, 0.8))]


def test_given_bodies_stand_in_place_of_the_drawn(tmp_path: Path) -> None:
    text = """[geometry.shapes]
Z_link = [{capsule = [0, 0, 100, 0, 0, 300], radius_mm = 40}, {box = [10, 20, 30], at = [1, 2, 3, 0, 0, 0]}]
X_link = [{mesh = "x.stl"}]
Y_link = [{sphere = [5, 0, 0], radius_mm = 20}, {hull = "y.stl"}]
base = []"""
    chain = chain_with(tmp_path, "ac_table_kin58", text)
    bodies = drawn_bodies(chain)
    ram = [body for body in bodies if body.link == "Z_link"]
    assert [(body.kind, body.origin) for body in ram] == [
        ("cylinder", "data"), ("sphere", "data"), ("sphere", "data"), ("box", "data")
    ]  # fmt: skip
    np.testing.assert_allclose([body.T_link_body[2, 3] for body in ram], [0.2, 0.1, 0.3, 0.003])
    assert ram[0].dimensions == pytest.approx((0.04, 0.2))
    assert not any(body.link == "base" for body in bodies)
    # What cannot be read is drawn by rule.
    assert undrawn_meshes(chain.geometry) == ("X_link", "Y_link")
    assert all(body.origin == "drawn" for body in bodies if body.link in ("X_link", "Y_link"))


def test_meshes_and_hulls_are_drawn_where_they_count(tmp_path: Path) -> None:
    part = joined(box((0, 0, 0), (300, 100, 50)), box((0, 0, 0), (50, 100, 300)))
    write_stl(tmp_path / "part.stl", part)
    text = """[geometry.shapes]
X_link = [{mesh = "part.stl", at = [10, 20, 30, 90, 0, 0]}, {sphere = [5, 0, 0], radius_mm = 20}]
Y_link = [{hull = "part.stl"}]"""
    chain = chain_with(tmp_path, "ac_table_kin58", text)
    assert undrawn_meshes(chain.geometry) == ()
    mesh, ball = (body for body in drawn_bodies(chain) if body.link == "X_link")
    assert (mesh.kind, ball.kind, mesh.origin) == ("mesh", "sphere", "data")
    assert mesh.dimensions == pytest.approx((0.3, 0.1, 0.3))
    assert mesh.surface is not None
    points = mesh.surface.points @ mesh.T_link_body[:3, :3].T + mesh.T_link_body[:3, 3]
    # Turned by 90° about z: x of the file is y of the link, y of the file is −x.
    np.testing.assert_allclose(points.min(axis=0), (0.01 - 0.1, 0.02, 0.03), atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), (0.01, 0.02 + 0.3, 0.03 + 0.3), atol=1e-6)
    (hull,) = (body for body in drawn_bodies(chain) if body.link == "Y_link")
    assert hull.surface is not None
    volume = np.einsum("ij,ij->", hull.surface.points[hull.surface.corners[:, 0]], hull.surface.normals) / 6
    # The hull of an L: a prism with five corners.
    assert volume == pytest.approx(0.1 * (0.3 * 0.3 - 0.25 * 0.25 / 2))
