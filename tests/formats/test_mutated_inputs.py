"""Thousands of broken archives, lists, URDF files, overlays and tables: each is read or refused in words.

What is read gives a finite pose: a value that arithmetic cannot hold is refused where it is read.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.collision.solids import solids_of
from chainbuild.errors import ChainbuildError
from chainbuild.formats.overlay import read_overlay
from chainbuild.tables.axes import AxisTable
from chainbuild.tables.form import PoseForm
from chainbuild.tables.poses import PoseTable
from chainbuild.tables.recording import read_recording
from tests.kit.bad_mutants import mutants

URDF = """<?xml version="1.0"?>
<robot name="bad">
<link name="world"/><link name="c"/>
<joint name="a" type="revolute">
<parent link="world"/><child link="c"/><origin xyz="0.1 0 0.3" rpy="0 0.5 0"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="2" velocity="3" effort="1"/>
</joint>
<joint name="b" type="prismatic">
<parent link="c"/><child link="d"/>
<axis xyz="0 1 0"/><limit lower="-0.5" upper="0.25"/>
</joint>
<joint name="m" type="continuous"><parent link="d"/><child link="e"/><origin xyz="0 0 0.2"/>
<axis xyz="1 0 0"/><mimic joint="a" multiplier="-0.5" offset="0.1"/>
</joint>
<joint name="f" type="fixed"><parent link="e"/><child link="t"/><origin xyz="0 0 0.1"/></joint>
</robot>
"""

OVERLAY = """name = "bad"
tool_length_mm = 20.5
endless = ["A4"]
[limits]
A1 = [-150, 150.5]
A2 = [-190, 45]
[limits.drives]
A3 = [-120, 156]
[speeds]
A1 = 300
A6 = 420.5
[conventions]
dpvn_axis = "z"
[tool]
[geometry]
ignore = [["A1_link", "A3_link"]]
rods = false
[geometry.radii_mm]
A2_link = 60
[geometry.shapes]
A3_link = [{capsule = [0, 0, 0, 300, 0, 0], radius_mm = 50}, {box = [10, 20, 30], at = [0, 0, 5, 0, 90, 0]}]
A5_link = [{sphere = [0, 0, 1], radius_mm = 40}]
"""

AXES_CSV = """A1,A2,A3,A4,A5,A6,status,position_error_mm,rotation_error_deg
0,-90,90,0,30,0,ok,0.0,0.0
10.5,-80,80.25,-5e1,20,1e2,ok,1e-9,2e-9
-10,-70.125,60,5,40,-100,"ok",,
"""

POSES_CSV = """x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,qx,qy,qz,qw
600,0,700.5,0,90,0,0,0.7071067811865476,0,0.7071067811865476
500.25,-100,6e2,0,90,0,0,0.7071067811865476,0,0.7071067811865476
"""

RECORDING_CSV = """A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg
0,-90,90,0,30,0,600,0,700.5,0,90,0
10.5,-80,80.25,-50,20,100,500.25,-100,600,10,20,30
"""

FILES = Path(chainbuild.__file__).parent / "machines" / "files"
Read = Callable[[Path], None]
KINDS = ("archive", "list", "urdf", "overlay", "axes", "poses", "recording")
EACH, MANY = 60, 20_000


@pytest.fixture(scope="module")
def robot() -> chainbuild.Robot:
    return chainbuild.Robot.load("kr6r900")


def build(robot: chainbuild.Robot) -> None:
    middle = np.array([(axis.lower + axis.upper) / 2 for axis in robot.axes])
    assert np.isfinite(robot.fk(middle).homogeneous).all()
    assert all(axis.lower < axis.upper for axis in robot.axes)


def read_urdf(path: Path) -> None:
    build(chainbuild.Robot.from_urdf(path, tool="t"))


def overlay_of(machine_file: Path) -> Read:
    def read(path: Path) -> None:
        chainbuild.check(machine_file, overlay=path)
        read_overlay(path)
        robot = chainbuild.Robot.load(machine_file, overlay=path)
        build(robot)
        assert all(np.isfinite(solid.reach) for solid in solids_of(robot.chain))

    return read


def read_machine(path: Path) -> None:
    chainbuild.check(path)
    build(chainbuild.Robot.load(path))


def without_comments(name: str, mark: str) -> str:
    """Return the lines of a shipped file that say something."""
    lines = (FILES / name).read_text("utf-8").splitlines()
    return "\n".join(line.split(mark)[0].rstrip() for line in lines if line.split(mark)[0].strip())


def readers(robot: chainbuild.Robot) -> dict[str, tuple[str, Read]]:
    def axes(path: Path) -> None:
        with AxisTable(path, robot.axes) as table:
            for _, values in table.rows():
                assert np.isfinite(values).all()

    def poses(path: Path) -> None:
        with PoseTable(path, PoseForm.of(robot.chain, robot.task)) as table:
            for row in table.rows():
                assert np.isfinite(row.T).all()

    def recording(path: Path) -> None:
        found = read_recording(path, robot.chain)
        assert np.isfinite(found.axes).all()
        assert np.isfinite(found.poses).all()

    channel = without_comments("kr6r900.tea", ";")
    program = "%_N_PART_MPF\n;$PATH=/_N_WKS_DIR\nN10 G1 X10 Y=R1 F500\nM30"
    return {
        "archive": (f"%_N_CH1_TEA\nCHANDATA(1)\n{channel}\n{program}\n", read_machine),
        "list": (without_comments("kr6r900_2.lis", "#") + "\n", read_machine),
        "urdf": (URDF, read_urdf),
        "overlay": (OVERLAY, overlay_of(FILES / "kr6r900.tea")),
        "axes": (AXES_CSV, axes),
        "poses": (POSES_CSV, poses),
        "recording": (RECORDING_CSV, recording),
    }


def refused(text: str, count: int, seed: int, read: Read, path: Path) -> int:
    """Read mutants; return how many are refused."""
    number = 0
    for n, changed in enumerate(mutants(text, count, seed)):
        path.write_bytes(changed.encode("utf-8", "surrogatepass"))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                read(path)
        except ChainbuildError as error:
            assert str(error)
            number += 1
        except Exception as error:
            raise AssertionError(f"mutant {n} of seed {seed} leaves {error!r}:\n{changed}") from error
    return number


@pytest.mark.parametrize("kind", KINDS)
def test_the_good_text_is_read(robot: chainbuild.Robot, tmp_path: Path, kind: str) -> None:
    text, read = readers(robot)[kind]
    path = tmp_path / f"good.{kind}"
    path.write_text(text)
    read(path)


@pytest.mark.parametrize("kind", KINDS)
def test_a_few_mutants_are_read_or_refused(robot: chainbuild.Robot, tmp_path: Path, kind: str) -> None:
    text, read = readers(robot)[kind]
    assert 0 < refused(text, EACH, 1, read, tmp_path / f"bad.{kind}") < EACH


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_thousands_of_mutants_are_read_or_refused(robot: chainbuild.Robot, tmp_path: Path, kind: str) -> None:
    text, read = readers(robot)[kind]
    assert MANY / 20 < refused(text, MANY, 2, read, tmp_path / f"bad.{kind}") < MANY
