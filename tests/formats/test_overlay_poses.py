"""Named poses of the overlay: what is refused and where, what is a finding, and which kinematics have them."""

from __future__ import annotations

from pathlib import Path

import pytest

import chainbuild
from chainbuild.chain.programmed.named import NamedPose
from chainbuild.errors import ChainbuildError
from chainbuild.formats.text import toml_line
from chainbuild.machines import shipped_path

HEAD = "trafo[0].id 9\nEnde\n"  # X, Y, Z, C, A


def machine(folder: Path, overlay: str, text: str = HEAD) -> chainbuild.Machine:
    path = folder / "head.lis"
    path.write_text(text, "utf-8")
    (folder / "head.chainbuild.toml").write_text(overlay, "utf-8")
    return chainbuild.load(path)


def copied(name: str, folder: Path, more: str, own: str | None = None) -> chainbuild.Machine:
    """Return a shipped machine with something more in its overlay."""
    source = shipped_path(name)
    assert source is not None
    kept = source.with_name(f"{name}.chainbuild.toml").read_text("utf-8") if own is None else own
    (folder / source.name).write_bytes(source.read_bytes())
    (folder / f"{name}.chainbuild.toml").write_text(f"{kept}\n{more}\n", "utf-8")
    return chainbuild.load(folder / source.name)


@pytest.mark.parametrize(
    ("text", "line", "parameter", "says"),
    [
        ("poses = 5", 1, "poses", "wrong type; permitted: a table [poses]"),
        ("[poses]\npark = 'home'", 2, "poses.park", "a list of axis values, or a table of axis = value, in mm and"),
        ("[poses]\npark = true", 2, "poses.park", "wrong type"),
        ("[poses]\nwait = [0, 0, 0, 0, 0]\npark = [0, 0, 0, 0]", 3, "poses.park", "4 values, the kinematic has 5 axes"),
        ("[poses]\npark = [0, 0, 0, 0]", 2, "poses.park", "permitted: 5 values, in mm and degrees: X, Y, Z, C, A"),
        ("[poses]\npark = []", 2, "poses.park", "has 0 values"),
        ("[poses]\npark = [0, 0, 'up', 0, 0]", 2, "poses.park", "wrong type; permitted: a finite"),
        ("[poses]\npark = [0, 0, true, 0, 0]", 2, "poses.park", "a finite number"),
        ("[poses]\npark = [0, 0, 0, [0], 0]", 2, "poses.park", "a finite number"),
        ("[poses]\npark = [0, 0, nan, 0, 0]", 2, "poses.park", "'poses.park' is nan"),
        ("[poses]\npark = [0, 0, 1e9, 0, 0]", 2, "poses.park", "is 1e+09; permitted: a finite number below 1e+09"),
        ("[poses]\npark = {X = 0, Y = 0, Z = 0, C = inf, A = 0}", 2, "poses.park.C", "'poses.park.C' is inf"),
        ("[poses]\npark = {X = 0, Y = 'a'}", 2, "poses.park.Y", "a finite number"),
        ("[poses]\npark = {X = 0, C = 0, A = 1}", 2, "poses.park", "pose 'park' leaves out Y and Z; parameter"),
        ("[poses]\npark = {}", 2, "poses.park", "leaves out X, Y, Z, C and A; parameter poses.park"),
        ("[poses]\npark = {Q = 1, X = 0}", 2, "poses.park.Q", "no axis 'Q'; parameter poses.park.Q"),
        ("[poses.park]\nX = 0\n\nx = 1", 4, "poses.park.x", "'X' and 'x' are the same axis X"),
        ("[poses]\n'1st' = [0, 0, 0, 0, 0]", 2, "poses", "the pose is called '1st'; parameter poses;"),
        ("[poses]\n'' = [0, 0, 0, 0, 0]", 2, "poses", "the pose is called ''"),
        ("[poses]\n'a<b' = [0, 0, 0, 0, 0]", 2, "poses", "the pose is called 'a<b'"),
        ("[poses]\n'a.b' = [0, 0, 0, 0, 0]", 2, "poses", "letters, digits, spaces, _ and -"),
        ("[poses]\n'end ' = [0, 0, 0, 0, 0]", 2, "poses", "the pose is called 'end '"),
    ],
)
def test_errors_point_at_their_line(text: str, line: int, parameter: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(ChainbuildError) as caught:
        machine(tmp_path, text).chain()
    assert says in str(caught.value)
    assert (caught.value.line, caught.value.parameter) == (line, parameter)
    assert caught.value.file == str(tmp_path / "head.chainbuild.toml")
    errors = [finding for finding in chainbuild.check(tmp_path / "head.lis") if finding.severity == "error"]
    assert caught.value.message in {finding.text for finding in errors}


def test_a_key_of_one_pose_is_not_looked_for_in_another() -> None:
    lines = ["[poses.park]", "X = 0", "[poses.wait]", "X = 1", "[limits]", "drives = {X = [0, 1]}"]
    assert toml_line(lines, ("poses", "park", "X")) == 2
    assert toml_line(lines, ("poses", "wait", "X")) == 4
    assert toml_line(lines, ("limits", "drives", "X")) == 6
    assert toml_line(["[poses]", "a = {X = 1}", "b = {X = 1}"], ("poses", "b", "X")) == 3


def test_lists_and_tables_say_the_same(tmp_path: Path) -> None:
    text = "[poses]\npark = [1, 2, -3.5, 4, 5]\n'tool change' = {A = 5, c = 4, Z = -3.5, Y = 2, X = 1}\n"
    chain = machine(tmp_path, text).chain()
    values = (1.0, 2.0, -3.5, 4.0, 5.0)
    assert chain.named_poses == (NamedPose("park", values), NamedPose("tool change", values))
    assert chain.with_axes(chain.axes).named_poses == chain.named_poses
    assert chain.with_drive_limits(()).named_poses == chain.named_poses


def test_a_pose_outside_the_limits_is_a_finding(tmp_path: Path) -> None:
    text = "[limits]\nX = [-10, 10]\n\n[poses]\nnear = [10, 0, 0, 0, 0]\nfar = [10.001, 0, 0, 0, 0]\n"
    chain = machine(tmp_path, text).chain()
    assert [pose.name for pose in chain.named_poses] == ["near", "far"]
    (finding,) = (finding for finding in chain.findings if finding.code in ("CB502", "CB503"))
    assert finding.text == "pose 'far' is outside the limits: X is 10.001, outside -10 … 10 mm"
    assert (finding.code, finding.severity, finding.parameter) == ("CB502", "warning", "poses.far")
    assert finding.span is not None
    assert finding.span.line == 6
    assert finding in chainbuild.check(tmp_path / "head.lis")


def test_a_pose_in_which_loops_do_not_close_is_a_finding(tmp_path: Path) -> None:
    chain = copied("delta_kin37", tmp_path, "[poses]\nopen = [180, 0, 0]\nclosed = [0, 0, 0]").chain()
    assert [pose.name for pose in chain.named_poses] == ["open", "closed"]
    (finding,) = (finding for finding in chain.findings if finding.code in ("CB502", "CB503"))
    assert finding.code == "CB503"
    assert finding.text.startswith("the kinematic cannot take pose 'open': ")


def test_poses_are_those_of_the_default_kinematic(tmp_path: Path) -> None:
    two = "trafo[0].id 9\ntrafo[1].id 45\n" + "".join(f"trafo[1].param[{n}] 4000000\n" for n in (6, 7, 8)) + "Ende\n"
    read = machine(tmp_path, "[poses]\npark = [0, 0, 0, 0, 0]\n", two)
    assert [pose.name for pose in read.chain().named_poses] == ["park"]
    assert read.chain(45).named_poses == ()
    robx = copied("irb2600", tmp_path, "[poses]\npark = [0, 0, 0, 0, 0, 0]")
    assert len(robx.chain().named_poses) == len(robx.chain("gripper").named_poses) == 1
    composed = copied("robot_head_kin210", tmp_path, f"[poses]\npark = {[0] * 11}").chain()
    assert [len(pose.axes) for pose in composed.named_poses] == [11]
    assert all(partial.chain.named_poses == () for partial in composed.partials)


def test_a_robx_file_of_two_transformations_has_poses_of_one(tmp_path: Path) -> None:
    """The other one may have other axes; reading translates both."""
    source = shipped_path("scara_cc")
    assert source is not None
    other = source.read_text("utf-8").replace("CHANDATA(1)", "CHANDATA(2)").replace("M17", "")
    arm = shipped_path("irb2600")
    assert arm is not None
    path = tmp_path / "both.tea"
    path.write_text(arm.read_text("utf-8").replace("M17", "") + other + "M17\n", "utf-8")
    (tmp_path / "both.chainbuild.toml").write_text("[poses]\npark = [0, 0, 0, 0, 0, 0]\n", "utf-8")
    read = chainbuild.load(path)
    assert [pose.name for pose in read.chain(channel=1).named_poses] == ["park"]
    assert read.chain(channel=2).named_poses == ()
