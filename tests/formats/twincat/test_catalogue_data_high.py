"""Checks the head-offset (HD) tables of the KIN_TYPs 36 to 213 against counts typed by hand from the KIN_TYP manual."""

from __future__ import annotations

import re
from typing import Any

import pytest

from tests.kit.type_files import CARRIES, EFFECTS, FAMILIES, load

# Channel order of the axes; the two letters say what kind and what it carries: l linear, r rotary; t tool, w workpiece.
AXES: dict[int, str] = {
    36: "C1:rt C2:rt Z:lt C3:rt",
    45: "C1:rt B1:rt B2:rt A1:rt B3:rt A2:rt",
    52: "X:lt Y:lt Z:lw A:rw B:rw",
    57: "X:lt Y:lt Z:lt B:rw C:rw",
    58: "X:lt Y:lt Z:lt A:rw C:rw",
    59: "X:lt Y:lt Z:lt C:rt A:rt",
    60: "X:lt Y:lt Z:lt C:rt B:rt",
    61: "X:lt Y:lw Z:lt A:rw B:rt",
    63: "X:lw Y:lw Z:lt A:rt B:rw",
    64: "X:lt Y:lt Z:lt C1:rw A:rw C2:rw",
    70: "X:lt Y:lt Z:lt B:rt A:rt CV:rt",
    76: "X:lt Y:lt Z:lt C:rt A:rt",
    80: "X:lt Y:lt Z:lt A:rw B:rw",
    81: "X:lt Y:lt Z:lt B:rw A:rw",
    82: "X:lt Y:lt Z:lt B:rt C:rw A:rt",
    85: "X:lt C:rt",
    96: "G1:rt G2:rt G3:rt G4:rt",
    98: "X:lt Y:lt Z:lt C:rt A:rt",  # the carrier that convention kin98_carrier assumes
    202: "XQ:lt YQ:rt ZQ:lt CS:rw",
    203: "C:rw YL:rt ZL:lt",
    205: "X:lt C:rt Z:lt",
    206: "A1:lt A2:rt A3:rt A4:rt A5:rt A6:rt",
    207: "X:lt Y:lt Z:lt C:rt",
    208: "A1:lt A2:rt A3:rt A4:rt A5:rt",
    213: "G1:rt G2:rt G3:rt G4:rt G5:rt",
}
# HD numbers of the tables as kinds: l length, a angle, f flag, s sign, n not assigned, "." no such row; blanks group.
HD: dict[int, str] = {
    36: "l ll ll afa",
    45: "lll aaa llllll .aa ..... ffffff .... flfff aaaa",
    52: "l l l ss",
    57: "lll lll lll aa ff lll",
    58: "lll lll lll aa ff lll",
    59: "lll lll a lll lll aa aa . af f",
    60: "lll lll a lll lll aa ..... f",
    61: "lll lll lll lll aa ff lll",
    63: "lll lll lll lll aa ff lll",
    64: "lll lll lll lll lll aaa fff",
    70: "l llll l aa ss ... a",
    76: "l .... a a lll",
    80: "lll lll lll lll aa ff",
    81: "lll lll lll lll aa ff",
    82: "lll lll lll lll lll aa ff",
    85: "l l a",
    96: "llllllllll",
    98: "l aaa",
    202: "l lll a lll a f",
    203: "l lll a lll a l",
    205: "l la ll lll lll a sss ff",
    206: "lll aaa nnn aal lllaaa lllaaa lllaaa lllaaa lllaaa a",
    207: ".ll aa . ll ll l",
    208: "lll aaa nnn aal lllaaa lllaaa lllaaa lllaaa",
    213: "lll ..a llllll .aa ..... fffff .......... aaa ......... l",
}
N_AXES = {36: 4, 45: 6, 52: 5, 57: 5, 58: 5, 59: 5, 60: 5, 61: 5, 63: 5, 64: 6, 70: 6, 76: 5, 80: 5, 81: 5, 82: 6,
          85: 2, 96: 4, 98: 5, 202: 4, 203: 3, 205: 3, 206: 6, 207: 4, 208: 5, 213: 5}  # fmt: skip
N_HD = {36: 8, 45: 29, 52: 5, 57: 16, 58: 16, 59: 20, 60: 16, 61: 19, 63: 19, 64: 21, 70: 11, 76: 6, 80: 16, 81: 16,
        82: 19, 85: 3, 96: 10, 98: 4, 202: 10, 203: 10, 205: 17, 206: 43, 207: 9, 208: 36, 213: 21}  # fmt: skip
# Chapters of the manual; 96, 202, 203 and 205 have no number of their own.
SECTIONS = {36: "3.1", 45: "3.3", 52: "2.26", 57: "2.27", 58: "2.28", 59: "2.29.1", 60: "2.29.2", 61: "2.30",
            63: "2.31", 64: "2.32", 70: "2.33", 76: "2.34", 80: "2.35", 81: "2.36", 82: "2.37", 85: "2.38", 98: "2.39",
            206: "3.4", 207: "2.40", 208: "3.5", 213: "3.6"}  # fmt: skip
COMPLETE = {45, 76, 96, 206, 208, 213}  # chapter 4.1; 98, 202, 203 and 205 are missing there

KIND = {"l": "length", "a": "angle", "f": "flag", "s": "sign", "n": "count"}
AXIS_KIND = {"l": "linear", "r": "rotary"}

TYPES = sorted(AXES)


def row(kin_typ: int, n: int) -> dict[str, Any]:
    """Returns the one row HD n of a type."""
    (found,) = [hd for hd in load(kin_typ)["hd"] if hd["n"] == n]
    return dict(found)


@pytest.mark.parametrize("kin_typ", TYPES)
def test_head_of_the_file(kin_typ: int) -> None:
    data = load(kin_typ)
    assert set(data) - {"display"} == {"kin_typ", "title", "family", "manual", "orientation", "summary", "axes", "hd"}
    assert data["kin_typ"] == kin_typ
    assert data["family"] in FAMILIES
    assert data["orientation"] == ("complete" if kin_typ in COMPLETE else "rtcp")
    assert data["title"]
    assert data["summary"].endswith(".")
    assert "\n" not in data["summary"]
    if kin_typ in SECTIONS:
        assert data["manual"] == f"KIN_TYP manual {SECTIONS[kin_typ]}"
    else:
        assert re.fullmatch(rf"KIN_TYP manual, KIN_TYP_{kin_typ} after [23][.\d]+ \(unnumbered\)", data["manual"])


@pytest.mark.parametrize("kin_typ", TYPES)
def test_axes_follow_the_channel_order(kin_typ: int) -> None:
    axes = load(kin_typ)["axes"]
    assert len(axes) == N_AXES[kin_typ]
    typed = [entry.split(":") for entry in AXES[kin_typ].split()]
    expected = [(name, AXIS_KIND[code[0]], CARRIES[code[1]]) for name, code in typed]
    assert [(a["name"], a["kind"], a["carries"]) for a in axes] == expected
    for axis in axes:
        assert set(axis) == {"name", "kind", "carries", "meaning"}
        assert axis["meaning"]


@pytest.mark.parametrize("kin_typ", TYPES)
def test_family_agrees_with_what_the_rotaries_carry(kin_typ: int) -> None:
    data = load(kin_typ)
    carried = {a["carries"] for a in data["axes"] if a["kind"] == "rotary"}
    expected = {"table": {"workpiece"}, "mixed": {"tool", "workpiece"}, "cardan": {"tool"}, "arm": {"tool"}}
    assert carried == expected.get(data["family"], carried)
    if carried == {"workpiece"}:
        assert data["family"] in {"table", "face"}


@pytest.mark.parametrize("kin_typ", TYPES)
def test_hd_rows_are_those_of_the_manual(kin_typ: int) -> None:
    rows = load(kin_typ)["hd"]
    assert len(rows) == N_HD[kin_typ]
    letters = HD[kin_typ].replace(" ", "")
    expected = [(n, KIND[letter]) for n, letter in enumerate(letters, start=1) if letter != "."]
    assert [(hd["n"], hd["kind"]) for hd in rows] == expected


@pytest.mark.parametrize("kin_typ", TYPES)
def test_hd_rows_are_well_formed(kin_typ: int) -> None:
    rows = load(kin_typ)["hd"]
    names = [hd["name"] for hd in rows]
    assert len(set(names)) == len(names)
    for hd in rows:
        assert set(hd) - {"permitted"} == {"n", "name", "kind", "default", "meaning", "effect"}
        assert re.fullmatch(r"[a-z][a-z0-9_]*", hd["name"])
        assert hd["kind"] in KIND.values()
        assert hd["effect"] in EFFECTS
        assert hd["meaning"].endswith(".")
        assert ("permitted" in hd) == (hd["kind"] in {"flag", "sign"})
        assert hd["default"] in hd.get("permitted", [0])
        if hd["kind"] == "sign":
            assert hd["permitted"] == [-1, 0, 1]


@pytest.mark.parametrize("kin_typ", TYPES)
def test_names_tell_the_kind_and_the_axis(kin_typ: int) -> None:
    data = load(kin_typ)
    kinds = {a["name"].lower(): a["kind"] for a in data["axes"]}
    for hd in data["hd"]:
        role, _, axis = hd["name"].removeprefix("internal_").partition("_")
        if role == "offset":
            assert hd["kind"] == ("length" if kinds[axis] == "linear" else "angle")
        if role == "direction":
            assert hd["kind"] in {"flag", "sign"}
            assert axis in kinds
        if hd["name"] in {"tool_x", "tool_y", "tool_z", "workpiece_x", "workpiece_y", "workpiece_z"}:
            assert hd["kind"] == "length"
        assert (hd["effect"] == "none") == (role == "unused") == (hd["kind"] == "count")


def test_the_tool_part_keeps_the_order_of_the_manual() -> None:
    for kin_typ in (45, 57, 58, 59, 60, 61, 63, 64, 80, 81, 82, 213):
        assert [row(kin_typ, n)["name"] for n in (1, 2, 3)] == ["tool_z", "tool_x", "tool_y"]
    for kin_typ in (206, 208):
        names = [row(kin_typ, n)["name"] for n in range(1, 7)]
        assert names == [*(f"tool_{c}" for c in "xyz"), *(f"tool_rotation_{c}" for c in "zyx")]
    assert [row(45, n)["name"] for n in (4, 5, 6)] == [f"tool_rotation_{c}" for c in "xyz"]


def test_the_zero_offsets_of_the_arms_are_numbered_as_in_the_manual() -> None:
    arm = {36: "c1", 14: "b1", 15: "b2", 37: "a1", 38: "b3", 39: "a2"}
    assert {n: row(45, n)["name"] for n in arm} == {n: f"offset_{axis}" for n, axis in arm.items()}
    palletiser = {36: "g1", 14: "g2", 15: "g3", 37: "g4", 38: "g5"}
    assert {n: row(213, n)["name"] for n in palletiser} == {n: f"offset_{axis}" for n, axis in palletiser.items()}


def test_rows_that_do_not_shape_the_pose() -> None:
    found = {(k, hd["n"]): hd["effect"] for k in TYPES for hd in load(k)["hd"] if hd["effect"] != "pose"}
    assert found == {
        **{(59, n): "control" for n in (19, 20, 21)},
        (60, 21): "control",
        (76, 6): "control",
        (76, 7): "control",
        (98, 4): "limit",
        **{(k, n): "none" for k in (206, 208) for n in (7, 8, 9)},
    }


def test_codes_with_more_than_two_values() -> None:
    assert row(45, 34)["permitted"] == [0, 1, 2, 3, 4, 5, 6]
    assert row(59, 20)["permitted"] == [0, 1, 2]
    flags = {(k, hd["n"]): hd["permitted"] for k in TYPES for hd in load(k)["hd"] if hd["kind"] == "flag"}
    assert {key for key, permitted in flags.items() if permitted != [0, 1]} == {(45, 34), (59, 20)}
