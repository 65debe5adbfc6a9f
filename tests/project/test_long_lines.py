"""Lines as long as a file may have them are read in no time, whatever stands in them."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, TableError
from chainbuild.formats.overlay import read_overlay
from chainbuild.formats.text import toml_line
from chainbuild.tables import AxisTable

LENGTH = 99_000  # just below tolerances.MAX_LINE_CHARACTERS
SECONDS = 5.0  # quadratic backtracking takes minutes

FILLINGS = ("1", " ", "a", "[", "]", "[0]", ".", "-", "'", '"', "$", "=", "N1 ", "1,", "1.", "ROBX_", "'H1", "e1", "#")
HEADS = {
    "tea": ("", "$MC_ROBX_NUM_AXES=", "$MC_ROBX_MAIN_LENGTH_AB[0]=1", "$MC_ROBX_NUM_AXES[", "N62905 ", "CHANDATA(",
            "$MA_POS_LIMIT_MINUS[", "$TC_DP3[", "%_N_", "N10 M30", "$MC_ROBX_NUM_AXES='B"),
    "lis": ("", "trafo[0].param[0] ", "trafo[0].name ", "trafo[", "trafo[0].", "wz[1].", "ori_rotation_angle ",
            "kenngr.swe_neg "),
}  # fmt: skip
FIRST = {"tea": "$MC_TRAFO_TYPE_1=4100\n", "lis": "trafo[0].id 9\n"}


@pytest.mark.parametrize(("suffix", "head"), [(suffix, head) for suffix, heads in HEADS.items() for head in heads])
def test_machine_files(suffix: str, head: str, tmp_path: Path) -> None:
    lines = [(head + filling * (LENGTH // len(filling)))[:LENGTH] + tail for filling in FILLINGS for tail in ("", "!")]
    path = tmp_path / f"long.{suffix}"
    path.write_text(FIRST[suffix] + "\n".join(lines), "utf-8")
    begin = time.perf_counter()
    chainbuild.check(path)
    assert time.perf_counter() - begin < SECONDS


@pytest.mark.parametrize(
    "content", ["\n" * 1_000_000, " \n" * 500_000 + "x", "<" * 90_000, "\n<\n" * 300_000, "[(" * 45_000]
)
def test_telling_the_dialect(content: str, tmp_path: Path) -> None:
    path = tmp_path / "blank.txt"
    path.write_text(content + "!", "utf-8")
    begin = time.perf_counter()
    assert [finding.severity for finding in chainbuild.check(path)] == ["error"]
    assert time.perf_counter() - begin < SECONDS


OVERLAYS = {
    "dotted key": "a" + ".a" * (LENGTH // 2) + " = 1",
    "dotted inline key": "x = {a" + ".a" * (LENGTH // 3) + " = 1}",
    "dotted header": "[" + "a." * (LENGTH // 3) + "a]",
    "brackets": "x = " + "[" * LENGTH,
    "digits": "x = " + "1" * LENGTH,
    "blanks before a bad key": "[limits]\n" + " " * LENGTH + "X = 5",
    "points": ". " * (LENGTH // 2),
}


@pytest.mark.parametrize("content", OVERLAYS.values(), ids=OVERLAYS)
def test_overlays(content: str, tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    path.write_text(content, "utf-8")
    begin = time.perf_counter()
    with pytest.raises(ChainbuildError):
        read_overlay(path)
    assert toml_line(content.split("\n"), ("limits", "X")) >= 0
    assert time.perf_counter() - begin < SECONDS


@pytest.mark.parametrize("filling", ["1", "1,", ",", '"', " ", "1.", "e", "_", "[(", "1;", "#", "1.000."])
def test_tables(filling: str, tmp_path: Path) -> None:
    axes = chainbuild.load("irb2600").chain().axes
    path = tmp_path / "long.csv"
    long = (filling * LENGTH)[:LENGTH]
    path.write_text("A1,A2,A3,A4,A5,A6\n1,2,3,4,5,x" + long + "\n", "utf-8")
    begin = time.perf_counter()
    with pytest.raises(TableError), AxisTable(path, axes) as table:
        list(table.rows())
    path.write_text(long, "utf-8")
    with pytest.raises(TableError):
        AxisTable(path, axes)
    assert time.perf_counter() - begin < SECONDS
