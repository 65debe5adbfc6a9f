"""Types written as KIN_TYP 91: equal poses, up to the constant shift that the list states."""

from __future__ import annotations

import re

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import UnsupportedKinematicError
from chainbuild.formats.twincat.universal.as_universal import as_universal, universal_of
from tests.kit.twincat_files import codes, machine, pose
from tests.kit.universal import shift

SERIAL = (
    1,
    2,
    3,
    4,
    5,
    6,
    7,
    8,
    9,
    10,
    11,
    16,
    17,
    18,
    22,
    23,
    25,
    28,
    30,
    33,
    34,
    52,
    57,
    58,
    61,
    63,
    64,
    76,
    80,
    81,
    82,
)
VECTORS = 2000


def random_list(kin: int, rng: np.random.Generator) -> str:
    lines = [f"trafo[0].id {kin}"]
    for row in chainbuild.catalogue()[kin].hd:
        if row.kind == "length":
            lines.append(f"trafo[0].param[{row.n - 1}] {round(rng.uniform(1e5, 3e6) * rng.choice([-1, 1]))}")
        elif row.kind == "angle":
            lines.append(f"trafo[0].param[{row.n - 1}] {round(rng.uniform(-9e5, 9e5))}")
    return "\n".join(lines)


@pytest.mark.parametrize("kin", SERIAL)
def test_equal_poses(kin: int) -> None:
    rng = np.random.default_rng(kin)
    of_type = machine(random_list(kin, rng))
    length = 0.0 if kin in (25, 33) else 64.5  # 25 keeps its nozzle's height, 33 its tip: no constant length
    chain = of_type.chain(tool_length_mm=length)
    universal = machine(as_universal(of_type)).chain(tool_length_mm=length)
    assert codes(universal) == []
    S = universal_of(of_type.chain()).shift
    this, other = chainbuild.Robot(chain), chainbuild.Robot(universal)
    zero = np.zeros(len(chain.axes))
    spin = np.linalg.inv(other.fk(zero).homogeneous) @ S @ this.fk(zero).homogeneous
    # A direction says nothing of the turn about it: tool frames may differ by a constant spin, by nothing else.
    assert spin[2, 2] == pytest.approx(1.0, abs=1e-12)
    assert spin[:3, 3] == pytest.approx(0.0, abs=1e-12)
    bound = np.array([800.0 if axis.kind == "linear" else 360.0 for axis in chain.axes])
    worst = 0.0
    for axes in rng.uniform(-bound, bound, (VECTORS, len(bound))):
        difference = other.fk(axes).homogeneous @ spin - S @ this.fk(axes).homogeneous
        worst = max(worst, float(np.abs(difference[:3, 3]).max()) * 1000.0, float(np.abs(difference[:3, :3]).max()))
    assert worst < 1e-9


def test_the_shift_is_stated() -> None:
    text = as_universal(chainbuild.load("ac_table_kin58"))
    assert "workpiece zero lies at X 0 Y 0 Z -560 (mm)" in text
    assert "axes are turned" not in text
    found = re.search(r"at X (\S+) Y (\S+) Z (\S+) \(mm\)", text)
    assert found
    S = shift(float(value) for value in found.groups())
    axes = [10.0, 20.0, -30.0, 40.0, 50.0]
    T = pose(chainbuild.load("ac_table_kin58").chain(), axes)
    assert pose(machine(text).chain(), axes) == pytest.approx(S @ T, abs=1e-9)
    assert "same coordinate system" in as_universal(chainbuild.load("ca_head_kin9"))


def test_a_turned_workpiece_is_stated() -> None:
    text = as_universal(machine("trafo[0].id 58\ntrafo[0].param[9] -900000"))
    assert "Its axes are turned: Rz(0) Ry(0) Rx(90), degrees." in text


def test_workpiece_axes_are_entered_multiplied_by_minus_one() -> None:
    text = as_universal(machine("trafo[0].id 58"))
    assert "trafo[0].axis[3].orientation[0] -1" in text
    assert "trafo[0].axis[4].orientation[2] -1" in text
    order = re.findall(r"chain\[\d\] (\d)", text)
    assert order == ["4", "3", "0", "1", "2"]


def test_a_tool_length_that_acts_otherwise_is_stated() -> None:
    for kin in (25, 33):
        assert "tools of length 0 only" in as_universal(machine(f"trafo[0].id {kin}"))
    assert "length" not in as_universal(chainbuild.load("ca_head_kin9"))


def test_the_conventions_used_are_stated() -> None:
    text = as_universal(machine("trafo[0].id 58"), conventions={"table_rotary_sense": "left_handed"})
    assert "# Convention table_rotary_sense = left_handed" in text
    assert "trafo[0].axis[3].orientation[0] 1\n" in text


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("cardan_head_kin59", "nonlinearly"),
        ("plasma_head_kin25", "nonlinearly"),
        ("scara_kin36", "three linear ones must come first"),
        ("palletiser_kin96", "together drive"),
        ("kr6r900", "three linear ones must come first"),
        ("c_face_kin14", "three linear ones must come first"),
    ],
)
def test_what_it_cannot_express(name: str, reason: str) -> None:
    with pytest.raises(UnsupportedKinematicError, match=reason):
        as_universal(chainbuild.load(name))


def test_a_gear_between_axes_cannot_be_expressed() -> None:
    # KIN_TYP 28: HD12/HD13 is the share of C in the motion of drive A.
    gear = machine("trafo[0].id 28\ntrafo[0].param[11] 1\ntrafo[0].param[12] 4")
    with pytest.raises(UnsupportedKinematicError, match="C and A together drive joint A"):
        as_universal(gear, conventions={"kin28_axis_values": "drives"})
