"""The bodies of a URDF: every kind in its place, colours, where meshes are sought, and what cannot be read."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import frames
from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.errors import ParseError
from chainbuild.findings import Collector, Finding
from chainbuild.formats.urdf.bodies import urdf_bodies
from chainbuild.formats.urdf.xml import parse
from chainbuild.meshes import read_triangles
from tests.kit.mesh_files import box, write_arm, write_dae, write_obj, write_stl

T_FORE = frames.f_frame((0.1, 0.2, 0.3), (40.0, -20.0, 70.0))
# The camera stands on the forearm: both are one link of the chain.
PLACES: Mapping[str, tuple[str, Matrix]] = {
    "base_link": ("base", np.eye(4)), "fore": ("A_link", np.eye(4)), "camera": ("A_link", T_FORE),
    "hand": ("B_link", np.eye(4)),
}  # fmt: skip
ORIGIN = '<origin xyz="1 2 3" rpy="0.1 -0.2 0.3"/>'
T_ORIGIN = frames.transform(
    frames.rot_z(np.degrees(0.3)) @ frames.rot_y(np.degrees(-0.2)) @ frames.rot_x(np.degrees(0.1)), (1.0, 2.0, 3.0)
)
ROUND = '<geometry><sphere radius="0.5"/></geometry>'


def read(text: str, urdf: Path) -> tuple[Geometry, list[Finding]]:
    collector = Collector()
    found = urdf_bodies(parse(f'<robot name="r">{text}</robot>', str(urdf)), PLACES, urdf, collector)
    return found, collector.findings


def link(name: str, *bodies: str) -> str:
    return f'<link name="{name}">{"".join(bodies)}</link>'


def body(tag: str, geometry: str, more: str = "") -> str:
    return f"<{tag}>{more}<geometry>{geometry}</geometry></{tag}>"


def one(tmp_path: Path, geometry: str, more: str = "", name: str = "camera") -> Shape:
    found, findings = read(link(name, body("collision", geometry, more)), tmp_path / "r.urdf")
    assert findings == []
    return found.shapes[PLACES[name][0]][0]


def test_every_kind_stands_where_the_file_puts_it(tmp_path: Path) -> None:
    T = T_FORE @ T_ORIGIN
    block = one(tmp_path, '<box size="0.1 0.2 0.3"/>', ORIGIN)
    assert (block.kind, block.size) == ("box", (0.1, 0.2, 0.3))
    np.testing.assert_allclose(frames.f_frame(block.place[:3], block.place[3:]), T, atol=1e-12)
    ball = one(tmp_path, '<sphere radius="0.4"/>', ORIGIN)
    assert (ball.kind, ball.radius) == ("sphere", 0.4)
    np.testing.assert_allclose(ball.points, T[:3, 3], atol=1e-12)
    for kind in ("cylinder", "capsule"):
        bar = one(tmp_path, f'<{kind} radius="0.05" length="0.6"/>', ORIGIN)
        assert (bar.kind, bar.radius) == (kind, 0.05)
        ends = [(T @ (0.0, 0.0, z, 1.0))[:3] for z in (-0.3, 0.3)]
        np.testing.assert_allclose(np.reshape(bar.points, (2, 3)), ends, atol=1e-12)


@pytest.mark.parametrize(("write", "suffix"), [(write_obj, "obj"), (write_stl, "stl"), (write_dae, "dae")])
def test_meshes_have_the_scale_of_the_file(tmp_path: Path, write, suffix: str) -> None:
    write(tmp_path / f"part.{suffix}", box((0, 0, 0), (1, 2, 3)))
    shape = one(tmp_path, f'<mesh filename="part.{suffix}" scale="0.1 -0.2 0.5"/>', ORIGIN)
    assert (shape.kind, shape.scale) == ("mesh", (0.1, -0.2, 0.5))
    np.testing.assert_allclose(frames.f_frame(shape.place[:3], shape.place[3:]), T_FORE @ T_ORIGIN, atol=1e-12)
    surface = read_triangles(str(shape.file), shape.scale)
    np.testing.assert_allclose(surface.points.min(axis=0), (0.0, -0.4, 0.0), atol=1e-12)
    np.testing.assert_allclose(surface.points.max(axis=0), (0.1, 0.0, 1.5), atol=1e-12)
    # Also mirrored its triangles look outwards.
    outwards = surface.points[surface.corners].mean(axis=1) - surface.points.mean(axis=0)
    assert (np.einsum("ij,ij->i", outwards, surface.normals) > 0.0).all()


@pytest.mark.parametrize(
    ("asset", "unit"),
    [("", 1.0), ('<unit name="millimeter" meter="0.001"/>', 0.001), ("<unit meter='0.0254'/>", 0.0254),
     ('<unit meter="0"/>', 1.0), ('<unit meter="inch"/>', 1.0)],
)  # fmt: skip
def test_the_unit_of_a_dae_file_counts(tmp_path: Path, asset: str, unit: float) -> None:
    write_dae(tmp_path / "part.dae", box((0, 0, 0), (1, 2, 3)), asset)
    assert one(tmp_path, '<mesh filename="part.dae" scale="2 2 2"/>').scale == (2 * unit,) * 3


def test_a_dae_file_in_millimetres_is_written_as_it_was_read(tmp_path: Path) -> None:
    write_dae(tmp_path / "l.dae", box((0, 0, 0), (100, 200, 300)), '<unit name="millimeter" meter="0.001"/>')
    path = write_arm(tmp_path)
    path.write_text(path.read_text("utf-8").replace("l.stl", "l.dae"), "utf-8")
    robot = chainbuild.Robot.from_urdf(path)
    again = chainbuild.from_urdf(chainbuild.write_urdf(robot, tmp_path / "out"), tool="tool")
    for chain in (robot.chain, again):
        (shape,) = chain.geometry.shapes["two"]
        assert shape.scale == pytest.approx((0.001,) * 3)


def test_links_without_collision_have_no_body_where_others_have_one(tmp_path: Path) -> None:
    text = link("fore", body("visual", '<box size="1 1 1"/>')) + link("hand", body("collision", '<box size="2 2 2"/>'))
    found, _ = read(text, tmp_path / "r.urdf")
    assert {name: len(shapes) for name, shapes in found.shapes.items()} == {"base": 0, "A_link": 0, "B_link": 1}
    assert {name: len(shapes) for name, shapes in found.visuals.items()} == {"base": 0, "A_link": 1, "B_link": 0}


def test_what_is_seen_counts_where_nothing_else_does(tmp_path: Path) -> None:
    text = link("fore", body("visual", '<box size="1 1 1"/>')) + link("camera", body("visual", '<sphere radius="1"/>'))
    found, _ = read(text, tmp_path / "r.urdf")
    assert [shape.kind for shape in found.shapes["A_link"]] == ["box", "sphere"]
    assert (found.shapes["B_link"], found.visuals) == ((), {})


def test_a_file_without_bodies_leaves_them_to_the_rules(tmp_path: Path) -> None:
    found, findings = read(link("fore") + link("hand"), tmp_path / "r.urdf")
    assert (found.shapes, found.visuals, findings) == ({}, {}, [])


def test_bodies_without_extent_are_none(tmp_path: Path) -> None:
    none = ('<box size="0 1 1"/>', '<sphere radius="0"/>', '<cylinder radius="0.1" length="0"/>')
    found, findings = read(link("fore", *(body("collision", one) for one in none)), tmp_path / "r.urdf")
    assert (found.shapes["A_link"], findings) == ((), [])


def test_colours_by_name_and_inline(tmp_path: Path) -> None:
    red, own = '<color rgba="1 0 0 0.5"/>', '<color rgba="0.1 0.2 7 1"/>'
    text = f'<material name="red">{red}</material>' + link(
        "fore",
        body("visual", '<box size="1 1 1"/>', '<material name="red"/>'),
        body("visual", '<box size="1 1 1"/>', f'<material name="own">{own}</material>'),
        body("visual", '<box size="1 1 1"/>', '<material name="nobody\'s"/>'),
        body("visual", '<box size="1 1 1"/>'),
    )
    text += link("hand", body("visual", '<box size="1 1 1"/>', '<material name="own"/>'))
    found, findings = read(text, tmp_path / "r.urdf")
    assert [shape.colour for shape in found.shapes["A_link"]] == [(1.0, 0.0, 0.0), (0.1, 0.2, 1.0), None, None]
    assert found.shapes["B_link"][0].colour == (0.1, 0.2, 1.0)
    assert findings == []


def test_a_texture_is_told_where_nothing_else_gives_a_colour(tmp_path: Path) -> None:
    texture, red = '<texture filename="wood.png"/>', '<color rgba="1 0 0 1"/>'
    text = link("fore", body("visual", '<box size="1 1 1"/>', f"<material name='a'>{texture}{red}</material>"))
    assert read(text, tmp_path / "r.urdf")[1] == []
    text = link("fore", body("visual", '<box size="1 1 1"/>', f"<material name='a'>{texture}</material>"))
    (finding,) = read(text, tmp_path / "r.urdf")[1]
    assert (finding.code, finding.severity) == ("CB527", "info")
    assert "link fore has no other colour" in finding.text


def test_where_meshes_are_sought(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    urdf = tmp_path / "arm description" / "urdf" / "r.urdf"
    for folder in (
        "arm description/urdf",
        "arm description/meshes",
        "other/meshes",
        "ros/deep/meshes",
        "ament/share/am",
    ):
        (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    part = box((0, 0, 0), (1, 1, 1))
    places = {
        "own.stl": "arm description/urdf/own.stl",
        "../meshes/up.stl": "arm description/meshes/up.stl",
        f"file://{tmp_path}/arm%20description/meshes/url.stl": "arm description/meshes/url.stl",
        f"{tmp_path}/absolute.stl": "absolute.stl",
        "package://arm description/meshes/within.stl": "arm description/meshes/within.stl",
        "package://other/meshes/beside.stl": "other/meshes/beside.stl",
        "package://deep/meshes/ros.stl": "ros/deep/meshes/ros.stl",
        "package://am/ament.stl": "ament/share/am/ament.stl",
    }
    for path in places.values():
        write_stl(tmp_path / path, part)
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path}/nowhere:{tmp_path}/ros")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}/ament")
    text = link("fore", *(body("collision", f'<mesh filename="{name}"/>') for name in places))
    found, findings = read(text, urdf)
    assert findings == []
    assert [shape.file.resolve() for shape in found.shapes["A_link"] if shape.file] == [
        (tmp_path / path).resolve() for path in places.values()
    ]
    # The entry of ROS_PACKAGE_PATH may be the package itself.
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path}/ros/deep")
    assert read(link("fore", body("collision", '<mesh filename="package://deep/meshes/ros.stl"/>')), urdf)[1] == []


def test_what_cannot_be_read_is_told_once_and_drawn_by_rule(tmp_path: Path) -> None:
    write_stl(tmp_path / "good.stl", box((0, 0, 0), (1, 1, 1)))
    write_obj(tmp_path / "far.obj", box((0, 0, 0), (1, 1, 1e9)))
    (tmp_path / "bad.stl").write_text("no mesh", "utf-8")
    (tmp_path / "empty.stl").write_text("", "utf-8")
    names = ("bad.stl", "empty.stl", "far.obj", "gone.stl", "http://far.example/a.stl", "package://p/a.stl")
    bodies = [body("collision", f'<mesh filename="{name}"/>') for name in ("good.stl", *names)]
    text = link("fore", *bodies) + "\n" + link("hand", body("collision", "<cone/>"), body("visual", ""))
    text += link("base_link", body("collision", '<mesh filename="good.stl"/>'))
    found, findings = read(text, tmp_path / "r.urdf")
    (finding,) = findings
    assert (finding.code, finding.severity, finding.span and finding.span.line) == ("CB526", "warning", 1)
    assert finding.text == (
        "bodies that cannot be read: bad.stl, empty.stl, far.obj, gone.stl (not found), "
        "http://far.example/a.stl (not found) and 3 more; their links are drawn by rule"
    )
    assert "ROS_PACKAGE_PATH" in str(finding.hint)
    assert {name: len(shapes) for name, shapes in found.shapes.items()} == {"base": 1}
    assert set(found.visuals) == {"base", "A_link"}


@pytest.mark.parametrize(
    ("geometry", "more", "parameter"),
    [
        ('<sphere radius="nan"/>', "", "radius"), ('<sphere radius="-0.1"/>', "", "radius"),
        ("<sphere/>", "", "radius"),
        ('<box size="1 -1 1"/>', "", "size"), ('<box size="1 1"/>', "", "size"), ('<box size="1 1 inf"/>', "", "size"),
        ('<cylinder radius="1" length="1e9"/>', "", "length"), ('<cylinder radius="1"/>', "", "length"),
        ('<mesh filename="a.stl" scale="1 0 1"/>', "", "scale"), ('<mesh filename="a.stl" scale="2"/>', "", "scale"),
        ("<mesh/>", "", "filename"), ('<box size="1 1 1"/>', '<origin xyz="0 0 1e9"/>', "xyz"),
        ('<box size="1 1 1"/>', '<origin rpy="0 0 x"/>', "rpy"),
        ('<box size="1 1 1"/>', '<material name="a"><color rgba="1 1 1"/></material>', "rgba"),
    ],
)  # fmt: skip
def test_numbers_that_make_no_sense_are_refused(tmp_path: Path, geometry: str, more: str, parameter: str) -> None:
    with pytest.raises(ParseError) as caught:
        read("\n" + link("fore", body("visual", geometry, more)), tmp_path / "r.urdf")
    assert (caught.value.line, caught.value.parameter) == (2, parameter)
