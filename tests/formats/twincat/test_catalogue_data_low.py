"""Checks the head-offset (HD) tables of the KIN_TYPs 1 to 34 against counts typed by hand from the KIN_TYP manual."""

from __future__ import annotations

import re

import pytest

from tests.kit.type_files import CARRIES, EFFECTS, FAMILIES, load

# Channel order of the axes; the lower-case letter says what they carry: t tool, w workpiece (sections 2.1 to 2.25).
AXES: dict[int, str] = {
    1: "Xw Yw Zt Bt Cw",
    2: "Xt Yt Zt At Bt",
    3: "Xt Yt Zt Bt",
    4: "Xt Yt Zt Bt",
    5: "Xt Yt Zt Ct",
    6: "Xt Yt Zt Ct",
    7: "Xt Yt Zt Ct",
    8: "Xt Yt Zt Ct",
    9: "Xt Yt Zt Ct At",
    10: "Xt Yt Zt Ct At",
    11: "Xt Yt Zw Aw Bt",
    13: "Xt Cw Zt",
    14: "Xt Cw Zt",
    16: "Xt Yt Zt Bt At",
    17: "Xt Yt Zt",
    18: "Xt Yt Zt",
    22: "Xw Yw Zt At Bt",
    23: "Xw Yw Zt At Bw",
    25: "Xt Yt Zt Ct At",
    28: "Xt Yt Zt Ct At",
    30: "Xt Yt Zt At",
    33: "Xt Yt Zt Ct At",
    34: "Xw Yt Zt Cw",
}
# HD numbers of the tables as kinds: l length, a angle, f flag, s sign, r ratio, n not assigned, "." no such row.
# The table of type 30 is missing in the scan; its row rests on the vendor's web documentation.
HD: dict[int, str] = {
    1: "lllllllllaa.ff",
    2: "lll",
    3: "lll",
    4: "lll",
    5: "lllla.ll",
    6: ".lla..llll",
    7: "llaallll",
    8: ".llaa.llll",
    9: "llaalllll",
    10: ".llaa.llll",
    11: "lla",
    13: "lnnlf",
    14: "lnnlf",
    16: "llllllaass",
    17: "llaallll",
    18: ".llaa.llll",
    22: "l..ss",
    23: "ll.ss",
    25: "llaalllll",
    28: "llaalllllnarrssrr",
    30: "lllsalll",
    33: "..alllf",
    34: ".ll",
}
N_AXES = {1: 5, 2: 5, 3: 4, 4: 4, 5: 4, 6: 4, 7: 4, 8: 4, 9: 5, 10: 5, 11: 5, 13: 3, 14: 3, 16: 5, 17: 3, 18: 3, 22: 5,
          23: 5, 25: 5, 28: 5, 30: 4, 33: 5, 34: 4}  # fmt: skip
N_HD = {1: 13, 2: 3, 3: 3, 4: 3, 5: 7, 6: 7, 7: 8, 8: 8, 9: 9, 10: 8, 11: 3, 13: 5, 14: 5, 16: 10, 17: 8, 18: 8, 22: 3,
        23: 4, 25: 9, 28: 17, 30: 8, 33: 5, 34: 2}  # fmt: skip
# Chapters of the manual, in its order; 13 and 14 share one.
SECTIONS = {1: 1, 2: 2, 3: 3, 4: 4, 5: 5, 6: 6, 7: 7, 8: 8, 9: 9, 10: 10, 11: 11, 13: 13, 14: 13, 16: 14, 17: 15,
            18: 16, 22: 19, 23: 20, 25: 21, 28: 22, 30: 23, 33: 24, 34: 25}  # fmt: skip

KIND = {"l": "length", "a": "angle", "f": "flag", "s": "sign", "r": "ratio", "n": "count"}

KINDS = {"length", "angle", "flag", "sign", "ratio", "count"}

TYPES = sorted(AXES)


@pytest.mark.parametrize("kin_typ", TYPES)
def test_head_of_the_file(kin_typ: int) -> None:
    data = load(kin_typ)
    assert set(data) - {"display"} == {"kin_typ", "title", "family", "manual", "orientation", "summary", "axes", "hd"}
    assert data["kin_typ"] == kin_typ
    assert data["family"] in FAMILIES
    assert data["orientation"] == "rtcp"  # table 4.1 of the manual: none of these types is a complete one
    assert data["manual"] == f"KIN_TYP manual 2.{SECTIONS[kin_typ]}"
    assert data["title"] and data["summary"].endswith(".")


@pytest.mark.parametrize("kin_typ", TYPES)
def test_axes_follow_the_channel_order(kin_typ: int) -> None:
    axes = load(kin_typ)["axes"]
    assert len(axes) == N_AXES[kin_typ]
    assert [(a["name"], a["carries"]) for a in axes] == [(t[0], CARRIES[t[1]]) for t in AXES[kin_typ].split()]
    for axis in axes:
        assert set(axis) == {"name", "kind", "carries", "meaning"}
        assert axis["kind"] == ("linear" if axis["name"] in "XYZ" else "rotary")
        assert axis["meaning"]


@pytest.mark.parametrize("kin_typ", TYPES)
def test_hd_rows_are_those_of_the_manual(kin_typ: int) -> None:
    rows = load(kin_typ)["hd"]
    assert len(rows) == N_HD[kin_typ]
    expected = [(n, KIND[letter]) for n, letter in enumerate(HD[kin_typ], start=1) if letter != "."]
    assert [(row["n"], row["kind"]) for row in rows] == expected


@pytest.mark.parametrize("kin_typ", TYPES)
def test_hd_rows_are_well_formed(kin_typ: int) -> None:
    rows = load(kin_typ)["hd"]
    names = [row["name"] for row in rows]
    assert len(set(names)) == len(names)
    for row in rows:
        assert set(row) - {"permitted"} == {"n", "name", "kind", "default", "meaning", "effect"}
        assert re.fullmatch(r"[a-z][a-z0-9_]*", row["name"])
        assert row["kind"] in KINDS and row["effect"] in EFFECTS
        assert row["meaning"].endswith(".")
        assert ("permitted" in row) == (row["kind"] in {"flag", "sign"})
        assert row["default"] in row.get("permitted", [0])


@pytest.mark.parametrize("kin_typ", TYPES)
def test_names_tell_the_kind(kin_typ: int) -> None:
    for row in load(kin_typ)["hd"]:
        if row["name"].startswith(("offset_", "setting_", "tilt_")):
            assert row["kind"] == "angle"
        if row["name"].startswith("direction_"):
            assert row["kind"] in {"flag", "sign"}
        assert (row["effect"] == "none") == row["name"].startswith("unused_")


def test_only_documented_rows_are_without_effect() -> None:
    unused = {(k, row["n"]) for k in TYPES for row in load(k)["hd"] if row["effect"] == "none"}
    assert unused == {(13, 2), (13, 3), (14, 2), (14, 3), (28, 10)}


def test_lost_table_is_marked() -> None:
    assert all("lost in the scan" in row["meaning"] for row in load(30)["hd"])
