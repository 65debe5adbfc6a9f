"""Denavit-Hartenberg tables as files: what they say beside numbers, how people write them, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import Robot
from chainbuild.errors import ChainbuildError

HEAD = "a,d,alpha,theta,kind,lower,upper"
ARM = (
    "25,400,-90,0,revolute,-170,170",
    "455,0,0,-90,revolute,-120,120",
    "35,0,-90,0,revolute,-120,120",
    "0,420,90,0,revolute,-180,180",
    "0,0,-90,0,revolute,-120,120",
    "0,80,0,180,revolute,-350,350",
)
PLAIN = "\n".join(["# standard", HEAD, *ARM]) + "\n"
AT = [10.0, -20.0, 30.0, 40.0, 50.0, 60.0]


def written(folder: Path, content: str | bytes, name: str = "arm.csv") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def pose(path: Path) -> np.ndarray:
    found: np.ndarray = Robot.load(path).fk(AT).homogeneous
    return found


def without_kinds(text: str) -> str:
    return "".join(",".join(line.split(",")[:4]) + "\n" for line in text.splitlines())


GERMAN = PLAIN.replace(",", ";").replace("455", "455,0")
HABITS = {
    "plain": PLAIN,
    "no_kinds": without_kinds(PLAIN),
    "words_around": PLAIN.replace("# standard", "# Denavit-Hartenberg, Standard convention (distal)"),
    "quoted": PLAIN.replace("# standard", '"# standard, drawing 4",,,,,,'),
    "no_space": PLAIN.replace("# standard", "#STANDARD"),
    "other_comments": PLAIN.replace("# standard", "# arm of cell 4\n\n# standard\n# 2024"),
    "units": PLAIN.replace(HEAD, "a [mm],d [mm],alpha [deg],theta [°],kind,lower,upper"),
    "units_behind": PLAIN.replace(HEAD, "a_mm,d_mm,alpha_deg,theta_deg,kind,lower,upper"),
    "greek": PLAIN.replace(HEAD, "a,d,α,θ,type,min,max"),
    "capitals": PLAIN.replace(HEAD, HEAD.upper()),
    "another_order": "\n".join(
        ",".join(np.array(line.split(","))[[3, 2, 1, 0, 4, 5, 6]]) if "," in line else line
        for line in PLAIN.splitlines()
    ),
    "letters": PLAIN.replace("revolute", "R"),
    "counted": "\n".join(["# standard", f"joint,{HEAD}", *(f"{n},{row}" for n, row in enumerate(ARM, start=1))]),
    "german": GERMAN,
    "german_excel": f"sep=;\r\n{GERMAN}".replace("# standard", "# standard;;;").replace("\n", ";;\r\n") + ";;;;;;\r\n",
    "tabs": PLAIN.replace(",", "\t"),
    "numpy": without_kinds(PLAIN).replace("a,d", "# a,d"),
    "indices": PLAIN.replace(HEAD, "a_i,d(i),α_{i} [deg],theta_i_deg,kind,lower,upper"),
    "links": "\n".join(["# standard", f"Link,{HEAD}", *(f"{n},{row}" for n, row in enumerate(ARM, start=1))]),
    "utf_16": PLAIN.encode("utf-16"),
    "bom": b"\xef\xbb\xbf" + PLAIN.encode(),
    "names": PLAIN.replace("upper", "upper,name").replace("170\n", "170,base\n").replace("0\n", "0,\n"),
}


@pytest.mark.parametrize("content", HABITS.values(), ids=HABITS)
def test_habits(tmp_path: Path, content: str | bytes) -> None:
    (tmp_path / "plain").mkdir()
    assert (pose(written(tmp_path, content)) == pose(written(tmp_path / "plain", PLAIN))).all()


def test_indices_of_the_link_before_are_those_of_a_modified_table(tmp_path: Path) -> None:
    plain = PLAIN.replace("# standard", "# modified")
    written_so = plain.replace(HEAD, "a(i-1),d_i,α_i-1,θ_i,kind,lower,upper")
    assert (pose(written(tmp_path, plain, "plain.csv")) == pose(written(tmp_path, written_so))).all()
    assert (pose(written(tmp_path, plain)) != pose(written(tmp_path, PLAIN))).any()


@pytest.mark.parametrize("name", ["arm.csv", "arm.txt", "arm.mpf", "arm"])
def test_the_content_tells_what_it_is(tmp_path: Path, name: str) -> None:
    machine = chainbuild.load(written(tmp_path, PLAIN, name))
    assert machine.dialect == "Denavit-Hartenberg"
    assert machine.chain().kinematic == "DH standard"


MISTAKES = {
    "no_convention": ("\n".join([HEAD, *ARM]), 1, "does not say which Denavit-Hartenberg convention it has"),
    "both": (PLAIN.replace("# standard", "# standard\n# modified"), 2, "the comments name both conventions"),
    "too_late": ("\n".join([HEAD, "# standard", *ARM]), 1, "does not say which"),
    "no_theta": (PLAIN.replace("theta", "offset"), 2, "unknown column 'offset'"),
    "misspelt": (
        PLAIN.replace("upper", "uper"),
        2,
        "unknown column 'uper'; permitted: a, d, alpha, theta, kind",
    ),
    "missing": ("# modified\na,alpha,theta\n1,2,3\n", 2, "missing column d"),
    "twice": (PLAIN.replace("lower,upper", "a [mm],upper"), 2, "column 'a' occurs twice"),
    "metres": (PLAIN.replace("a,d", "a [m],d"), 2, "column 'a [m]': a is in mm; permitted: a [mm]"),
    "radians": (PLAIN.replace("theta", "theta [rad]"), 2, "column 'theta [rad]': theta is in deg"),
    "radians_behind": (PLAIN.replace("theta", "theta_rad"), 2, "column 'theta_rad': theta is in deg"),
    "link_before": (
        PLAIN.replace("a,d,alpha", "a(i-1),d(i),alpha"),
        2,
        "column 'a(i-1)' is of the link before, as in a m",
    ),
    "offset": (PLAIN.replace("upper", "offset"), 2, "name; add it to theta of the row, of a prismatic joint to d"),
    "limits_in_a_unit": (PLAIN.replace("lower", "lower [deg]"), 2, "lower is in the unit of its joint"),
    "variable": (PLAIN.replace("-90,0,revolute", "-90,q1,revolute", 1), 3, "'q1' is not a number"),
    "empty_cell": (PLAIN.replace("455,0,", "455,,"), 4, "column d: no value"),
    "nan": (PLAIN.replace("455", "nan"), 4, "column a: 'nan' is not a number"),
    "huge": (PLAIN.replace("455", "1e12"), 4, "column a: '1e12' is not a number"),
    "thousands": (GERMAN.replace("455,0", "1.455,0"), 4, "without thousands separators"),
    "kind": (PLAIN.replace("revolute", "hinge", 1), 3, "'hinge' is no kind of a joint; permitted: revolute (R), pris"),
    "no_kind": (PLAIN.replace("revolute", "", 1), 3, "the row has no kind"),
    "one_limit": (PLAIN.replace("-170,170", "-170,"), 3, "column upper: no value"),
    "limits_reversed": (PLAIN.replace("-170,170", "170,-170"), 3, "the limits leave no range: 170 to -170"),
    "short": (PLAIN.replace("0,80,0,180,revolute,-350,350", "0,80,0"), 8, "the row has no kind"),
    "long": (PLAIN.replace("-350,350", "-350,350,1"), 8, "the row has 8 values, the header 7 columns"),
    "no_rows": (f"# standard\n{HEAD}\n", 0, "the table has no joints"),
    "only_fixed": (f"# standard\n{HEAD}\n1,2,3,4,fixed,,\n", 0, "the table has no joints"),
    "fixed_with_limits": (f"# standard\n{HEAD}\n1,2,3,4,fixed,-1,1\n", 3, "a fixed row has no axis"),
    "same_names": ("# modified\na,d,alpha,theta,name\n0,0,0,0,J\n0,0,90,0,j\n", 4, "two axes are called j"),
    "miscounted": (f"# modified\ni,{HEAD}\n2,0,0,0,0,R,,\n", 3, "the axis is called '2'"),
    "reserved": ("# modified\na,d,alpha,theta,name\n0,0,0,0,x_mm\n", 3, "the axis is called 'x_mm' like a column"),
    "name_of_a_frame": ("# modified\na,d,alpha,theta,name\n0,0,0,0,tool\n", 3, "like a frame of the model"),
}


@pytest.mark.parametrize(("content", "line", "text"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes(tmp_path: Path, content: str, line: int, text: str) -> None:
    path = written(tmp_path, content)
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.load(path).chain()
    assert text in str(caught.value)
    assert str(caught.value).startswith(f"{path}:{line}: " if line else f"{path}: ")
    assert [finding.severity for finding in chainbuild.check(path)] == ["error"]


def test_without_a_convention_both_are_explained(tmp_path: Path) -> None:
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.load(written(tmp_path, "\n".join([HEAD, *ARM])))
    said = str(caught.value)
    assert "'# standard'" in said
    assert "Rz(theta) Tz(d) Tx(a) Rx(alpha)" in said
    assert "'# modified'" in said
    assert "Rx(alpha) Tx(a) Rz(theta) Tz(d)" in said


def test_axes_have_kinds_names_and_limits(tmp_path: Path) -> None:
    text = (
        "# modified\na,d,alpha,theta,kind,lower,upper,name\n0,0,0,0,P,-5,1000,RAIL\n0,0,90,0,R,,,\n1,0,0,0,fixed,,,\n"
    )
    axes = Robot.load(written(tmp_path, text)).axes
    assert [(one.name, one.unit, one.lower, one.upper, one.assumed) for one in axes] == [
        ("RAIL", "mm", -5.0, 1000.0, False),
        ("A2", "deg", -360.0, 360.0, True),
    ]


def test_an_overlay_adds_what_the_table_does_not_say(tmp_path: Path) -> None:
    path = written(tmp_path, without_kinds(PLAIN))
    overlay = tmp_path / "arm.chainbuild.toml"
    overlay.write_text(
        'name = "Arm"\ntool_length_mm = 50\n[limits]\nA1 = [-90, 90]\n[limits.sums]\n"A2+A3" = [-60, 100]\n'
        "[speeds]\nA2 = 100\n[poses]\npark = [0, -90, 90, 0, 0, 0]\n[geometry.radii_mm]\nA2_link = 50\n",
        "utf-8",
    )
    robot = Robot.load(path)
    assert (robot.axes[0].lower, robot.axes[1].max_speed, robot.chain.title) == (-90.0, 100.0, "Arm")
    assert [pose.name for pose in robot.chain.named_poses] == ["park"]
    assert robot.violated_limits([0, 60, 60, 0, 0, 0]) == ("A2+A3",)
    tool = robot.fk(AT).homogeneous
    overlay.unlink()
    bare = pose(path)
    assert np.abs(tool[:3, 3] - bare[:3, 3] - 0.05 * bare[:3, 2]).max() < 1e-14
    overlay.write_text('[conventions]\nkin45_b3 = "x"\n', "utf-8")
    with pytest.raises(ChainbuildError):
        Robot.load(path)
    overlay.write_text("kinematic = 3\n", "utf-8")
    with pytest.raises(ChainbuildError, match="the file configures no kinematic 3"):
        Robot.load(path)


def test_numbers_that_look_like_radians_or_metres_are_told(tmp_path: Path) -> None:
    path = written(tmp_path, "# standard\na,d,alpha,theta\n0,0.4,-1.5708,0\n0.455,0,0,-1.5708\n")
    found = {finding.code: finding for finding in chainbuild.check(path)}
    assert found["CB531"].span is not None
    assert found["CB531"].span.line == 3
    assert "alpha -1.5708 and all other angles look like radians" in found["CB531"].text
    assert "CB514" in found
    assert not {"CB531", "CB514"} & {finding.code for finding in chainbuild.check(written(tmp_path, PLAIN))}


def test_a_wrong_number_is_found_by_poses(tmp_path: Path) -> None:
    true = Robot.load(written(tmp_path, PLAIN))
    rows = np.random.default_rng(0).uniform(-80, 80, (5, 6)).round(3)
    recorded = [true.fk(row).homogeneous for row in rows]
    machine = chainbuild.load(written(tmp_path, PLAIN.replace("35,0", "38,0")))
    recording = chainbuild.Recording(rows, np.array(recorded))
    found = chainbuild.crosscheck(Robot(machine.chain()), recording, machine=machine)
    assert not found.agrees
    assert found.data[0].agrees
    assert [(datum.name, round(value, 6)) for datum, value in found.data[0].values.items()] == [("a3", 35.0)]


def test_data_can_be_changed(tmp_path: Path) -> None:
    machine = chainbuild.load(written(tmp_path, PLAIN))
    data = {datum.name: datum for datum in machine.geometry()}
    assert len(data) == 24
    assert data["a2"].span is not None
    assert data["a2"].span.line == 4
    changed = machine.with_values({data["a2"]: 460.0, data["theta6"]: 170.0})
    again = written(tmp_path, PLAIN.replace("455", "460").replace("0,180,", "0,170,"))
    assert (Robot(changed.chain()).fk(AT).homogeneous == pose(again)).all()
