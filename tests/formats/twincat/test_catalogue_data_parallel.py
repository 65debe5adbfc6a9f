"""Checks the head-offset (HD) tables of the parallel KIN_TYPs against counts typed by hand from the KIN_TYP manual."""

from __future__ import annotations

import re
import tomllib

import pytest

from chainbuild.convention import applying_to, conventions
from chainbuild.formats.twincat.lists.hdtable import type_data
from tests.kit.paths import PACKAGE
from tests.kit.type_files import CARRIES, EFFECTS, FAMILIES, load

# Channel order of the axes; the two letters say what kind and what it carries: l linear, r rotary; t tool, w workpiece.
AXES: dict[int, str] = {
    12: "Z1:lt Z2:lt Z3:lt",
    19: "X:lt Y:lt Z1:lw Z2:lw Z3:lw",
    21: "X1:lt X2:lt Z:lt C:rt",
    37: "J1:rt J2:rt J3:rt",
    209: "Z1:lt Z2:lt Z3:lt A:rw C:rw",
}
# HD numbers of the tables as kinds: l length, a angle, f flag, n bare number, "." no such row; blanks group.
HD: dict[int, str] = {
    12: "lll l lll faa",
    19: "l l l l l",
    21: "l lll l a l aa l l n",
    37: "l nn ll ll aaa aa l",
    209: "lll l lll faa ..... ..... ..... .... a f lll lll aa ff",
}
N_HD = {12: 10, 19: 5, 21: 12, 37: 13, 209: 22}
SECTIONS = {12: "2.12", 19: "2.17", 21: "2.18", 37: "3.2", 209: "2.41"}
COMPLETE = {12, 19, 21, 37}  # chapter 4.1
TITLES = {
    12: "Tripod", 19: "Table on three rods", 21: "Lambda kinematic", 37: "Delta robot",
    209: "Tripod with a two-axis workpiece table",
}  # fmt: skip
DISPLAY = {
    12: {"kind": "position"},
    19: {"kind": "vector", "columns": ["tool_x", "tool_y", "tool_z"]},
    21: {"kind": "plane", "columns": ["c_deg"], "along": "x"},
    37: {"kind": "position"},
    209: {"kind": "axes", "solved": ["Z1", "Z2", "Z3"]},
}
NAMES: dict[int, dict[int, str]] = {
    12: {1: "tool_z", 2: "tool_y", 3: "tool_x", 4: "machine_zero_z", 5: "column_radius", 6: "platform_radius",
         7: "rod_length", 8: "not_ideal", 9: "angle_31", 10: "angle_32"},
    19: {1: "tool_z", 2: "rod_length", 3: "table_radius", 4: "column_radius", 5: "table_height"},
    21: {1: "tool_z", 2: "rod_b", 3: "rod_c", 4: "gripper_arm", 5: "joint_offset", 6: "fixed_angle", 7: "slide_y",
         8: "angle_lower", 9: "angle_upper", 10: "offset_x", 11: "gripper_offset", 12: "variant"},
    37: {1: "tool_z", 2: "unused_2", 3: "unused_3", 4: "platform_radius", 5: "base_radius", 6: "rod_length",
         7: "lever_length", 8: "zero_j1", 9: "zero_j2", 10: "zero_j3", 11: "joint_lower", 12: "joint_upper",
         13: "machine_zero_z"},
}  # fmt: skip
TABLE = {
    30: "column_angle", 31: "second_axis_b", 32: "rotary_to_c_x", 33: "rotary_to_c_y", 34: "rotary_to_c_z",
    35: "machine_to_rotary_x", 36: "machine_to_rotary_y", 37: "machine_to_rotary_z", 38: "offset_a", 39: "offset_c",
    40: "direction_a", 41: "direction_c",
}  # fmt: skip
NAMES[209] = NAMES[12] | TABLE
KIND = {"l": "length", "a": "angle", "f": "flag", "n": "count"}
AXIS_KIND = {"l": "linear", "r": "rotary"}
TYPES = sorted(AXES)
# Shared with the serial tables: the table of 209.
SHARED = {"table_rotary_sense", "table_flag_coding", "offset_inside_flag"}


@pytest.mark.parametrize("kin_typ", TYPES)
def test_head_of_the_file(kin_typ: int) -> None:
    data = load(kin_typ)
    assert set(data) == {"kin_typ", "title", "family", "manual", "orientation", "summary", "axes", "hd", "display"}
    assert (data["kin_typ"], data["title"]) == (kin_typ, TITLES[kin_typ])
    assert data["family"] == "parallel" and "parallel" in FAMILIES
    assert data["orientation"] == ("complete" if kin_typ in COMPLETE else "rtcp")
    assert data["manual"] == f"KIN_TYP manual {SECTIONS[kin_typ]}"
    assert data["summary"].endswith(".") and "\n" not in data["summary"]
    assert data["display"] == DISPLAY[kin_typ]


@pytest.mark.parametrize("kin_typ", TYPES)
def test_axes_follow_the_channel_order(kin_typ: int) -> None:
    typed = [entry.split(":") for entry in AXES[kin_typ].split()]
    expected = [(name, AXIS_KIND[code[0]], CARRIES[code[1]]) for name, code in typed]
    axes = load(kin_typ)["axes"]
    assert [(a["name"], a["kind"], a["carries"]) for a in axes] == expected
    assert all(set(axis) == {"name", "kind", "carries", "meaning"} and axis["meaning"] for axis in axes)


@pytest.mark.parametrize("kin_typ", TYPES)
def test_hd_rows_are_those_of_the_manual(kin_typ: int) -> None:
    rows = load(kin_typ)["hd"]
    assert len(rows) == N_HD[kin_typ]
    letters = HD[kin_typ].replace(" ", "")
    expected = [(n, KIND[letter]) for n, letter in enumerate(letters, start=1) if letter != "."]
    assert [(hd["n"], hd["kind"]) for hd in rows] == expected
    assert {hd["n"]: hd["name"] for hd in rows} == NAMES[kin_typ]


@pytest.mark.parametrize("kin_typ", TYPES)
def test_hd_rows_are_well_formed(kin_typ: int) -> None:
    for hd in load(kin_typ)["hd"]:
        assert set(hd) - {"permitted"} == {"n", "name", "kind", "default", "meaning", "effect"}
        assert hd["effect"] in EFFECTS
        assert hd["meaning"].endswith(".")
        assert hd["default"] == 0
        assert hd.get("permitted") == ([0, 1] if hd["kind"] == "flag" else None)
        assert (hd["effect"] == "none") == hd["name"].startswith("unused_")


def test_rows_that_do_not_shape_the_pose() -> None:
    found = {(k, hd["n"]): hd["effect"] for k in TYPES for hd in load(k)["hd"] if hd["effect"] != "pose"}
    limits = {(21, 8): "limit", (21, 9): "limit", (37, 11): "limit", (37, 12): "limit"}
    assert found == {**limits, (21, 12): "control", (37, 2): "none", (37, 3): "none"}
    read_only = {n: hd["meaning"] for hd in load(21)["hd"] if (n := hd["n"]) in (8, 9, 12)}
    assert all("read, not applied" in meaning for meaning in read_only.values())


def test_the_table_of_209_stands_on_the_tripod_of_12() -> None:
    tripod = load(12)["hd"]
    assert load(209)["hd"][: len(tripod)] == tripod
    assert load(209)["axes"][:3] == load(12)["axes"]


def test_the_reader_takes_them() -> None:
    for kin_typ in TYPES:
        data = type_data()[kin_typ]
        assert [row.name for row in data.hd] == [NAMES[kin_typ][n] for n in sorted(NAMES[kin_typ])]
        assert dict(data.display) == DISPLAY[kin_typ]


# ---------------------------------------------------------------- conventions


def own() -> dict[str, dict[str, object]]:
    """Parse the conventions of the parallel types."""
    return tomllib.loads((PACKAGE / "data" / "conventions_twincat_parallel.toml").read_text("utf-8"))


@pytest.mark.parametrize("kin_typ", TYPES)
def test_conventions_of_a_type(kin_typ: int) -> None:
    named = {convention.name for convention in applying_to([f"KIN {kin_typ}"])}
    columns = {f"kin12_{name}" for name in ("azimuth", "numbering", "carriages", "hd4_sign", "tool_xy", "tool_xy_sign",
                                            "z_positive")}  # fmt: skip
    lever = ("azimuth", "numbering", "hd1_sign", "hd13_sign", "limits_of")
    slides = ("side", "hd5_along", "c_zero", "hd10_sign", "beta_sign", "slides")
    expected = {
        12: columns,
        19: {f"kin19_{name}" for name in ("guide", "azimuth", "numbering", "carriages")},
        21: {f"kin21_{name}" for name in slides},
        37: {f"kin37_{name}" for name in lever},
        209: {*columns, "kin209_column_angle"} | SHARED,
    }
    assert named == expected[kin_typ]


@pytest.mark.parametrize("name", sorted(own()))
def test_a_convention_is_complete(name: str) -> None:
    entry = conventions()[name]
    assert entry.default == ("" if name == "kin19_guide" else next(iter(entry.choices)))
    assert len(entry.choices) > 1 and all(entry.choices.values())
    assert entry.question.endswith("?") and entry.why.endswith(".") and entry.verify.endswith(".")
    assert entry.mark in ("I", "?")
    assert re.match(r"KIN_TYP manual [1-4]\.", entry.source)
    number = name.split("_", 1)[0].removeprefix("kin")
    assert f"KIN {number}" in entry.applies
    # A choice is told apart on the controller: the way to verify it names choices, not numbers of the text.
    assert any(choice in entry.verify for choice in entry.choices)


def test_choices_of_directions() -> None:
    assert list(conventions()["kin12_azimuth"].choices) == ["deg_0", "deg_90", "deg_180", "deg_minus_90"]
    assert list(conventions()["kin19_azimuth"].choices) == ["deg_0", "deg_90", "deg_180", "deg_minus_90"]
    assert list(conventions()["kin37_azimuth"].choices) == ["deg_minus_90", "deg_0", "deg_90", "deg_180"]
    signs = {name: list(entry.choices) for name, entry in conventions().items() if name in own() and "sign" in name}
    assert signs == {
        "kin12_hd4_sign": ["minus", "plus"],
        "kin12_tool_xy_sign": ["minus", "plus"],
        "kin37_hd1_sign": ["minus", "plus"],
        "kin37_hd13_sign": ["minus", "plus"],
        "kin21_hd10_sign": ["plus", "minus"],
        "kin21_beta_sign": ["plus", "minus"],
    }
