"""Tables as people have them: what Excel, numpy and others write is read, and what may mean two things is refused."""

from __future__ import annotations

import gzip
import io
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.elements import Axis
from chainbuild.errors import ChainbuildError, FileAccessError, TableError
from chainbuild.tables import AxisTable, PoseForm, PoseTable

AXES = (Axis.unlimited("A1", "rotary"), Axis.unlimited("X", "linear"))
VALUES = [[1.5, -300.0], [0.25, 1200.125]]


def read(path: Path) -> list[list[float]]:
    with AxisTable(path, AXES) as table:
        return [values.tolist() for _, values in table.rows()]


def written(folder: Path, content: str | bytes) -> Path:
    path = folder / "table.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


COMMA = "A1,X\n1.5,-300\n0.25,1200.125\n"
SEMICOLON = "A1;X\r\n1,5;-300\r\n0,25;1200,125\r\n"
HABITS: dict[str, str | bytes] = {
    "decimal_comma": SEMICOLON,
    "semicolon_and_point": COMMA.replace(",", ";"),
    "tabs": COMMA.replace(",", "\t"),
    "tabs_and_decimal_comma": SEMICOLON.replace(";", "\t"),
    "units": "A1 [deg];X [mm]\n1,5;-300\n0,25;1200,125\n",
    "units_in_round_brackets": "a1 (°),x(mm)\n1.5,-300\n0.25,1200.125\n",
    "degree_sign_of_excel": SEMICOLON.replace("A1", "A1 [°]").encode("cp1252"),
    "excel_line": f"sep=;\r\n{SEMICOLON}",
    "excel_line_in_quotes": f'"sep=;"\n{SEMICOLON}',
    "excel_line_and_empty_columns": f"sep=,,,\n{COMMA}",
    "quoted_cells": '"A1";"X"\n"1,5";"-300"\n"0,25";"1200,125"\n',
    "empty_columns": "A1;X;;;\n1,5;-300;;;\n0,25;1200,125;;;\n",
    "empty_rows": "A1;X\n1,5;-300\n;\n;;;\n0,25;1200,125\n;;;;;\n",
    "empty_rows_before": f";;\n\n{SEMICOLON}",
    "empty_quoted_rows": 'A1,X\n1.5,-300\n"",""\n0.25,1200.125\n',
    "comments": "# of the cell\nA1,X\n  # first\n1.5,-300\n#\n0.25,1200.125\n# end\n",
    "header_of_numpy": "# A1,X\n1.5,-300\n0.25,1200.125\n",
    "exponents_of_numpy": "# A1;X\n1.500000000000000000e+00;-3.0e+02\n2.5e-01;1.200125e+03\n",
    "bom": b"\xef\xbb\xbf" + SEMICOLON.encode(),
    "utf_16": COMMA.encode("utf-16"),
    "utf_16_big": b"\xfe\xff" + SEMICOLON.encode("utf-16-be"),
    "utf_16_without_mark": SEMICOLON.encode("utf-16-le"),
    "utf_16_big_without_mark": SEMICOLON.encode("utf-16-be"),
    "old_mac": SEMICOLON.replace("\r\n", "\r"),
    "result_columns": "X;A1;status;violations\n-300;1,5;ok;\n1200,125;0,25;ok;A1, A2\n",
    "generated": "A1;X\n+1.50;-3e2\n.25;1200.125\n",
}


@pytest.mark.parametrize("content", HABITS.values(), ids=HABITS)
def test_habits(tmp_path: Path, content: str | bytes) -> None:
    assert read(written(tmp_path, content)) == VALUES


def test_numpy_writes_a_table_that_is_read(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "saved.csv", VALUES, delimiter=",", header="A1,X")
    assert read(tmp_path / "saved.csv") == VALUES


REFUSED: dict[str, tuple[str | bytes, int, str]] = {
    "thousands": ("A1;X\n1,5;1.200,5\n", 2, "column X: '1.200,5' has thousands separators"),
    "thousands_in_quotes": ('A1,X\n1.5,"1,200.5"\n', 2, "column X: '1,200.5' has thousands separators"),
    "thousands_swiss": ("A1;X\n1.5;1'200.5\n", 2, "'1'200.5' has thousands separators"),
    "thousands_blank": ("A1;X\n1,5;1 200,5\n", 2, "'1 200,5' has thousands separators"),
    "millions": ("A1;X\n1,5;1.200.500\n", 2, "'1.200.500' has thousands separators"),
    "two_marks": ("A1;X\n1,5;200\n1,5;1.200\n", 3, "'1.200' has a point, numbers before it have a comma"),
    "two_marks_in_a_row": ("A1;X\n1.5;1,200\n", 2, "'1,200' has a comma, numbers before it have a point"),
    "unit_in_a_cell": ("A1,X\n1.5,300 mm\n", 2, "'300 mm' is no bare number: units stand in the header"),
    "degree_in_a_cell": ("A1;X\n1,5°;300\n", 2, "'1,5°' is no bare number"),
    "excel_error": ("A1;X\n#WERT!;300\n", 2, "column A1: '#WERT!' is not a number"),
    "excel_not_available": ("A1;X\n#N/A;300\n", 2, "column A1: '#N/A' is not a number"),
    "formula": ("A1;X\n1,5;=B1\n", 2, "'=B1' is not a number"),
    "nan": ("A1;X\n1,5;nan\n", 2, "column X: 'nan' is not finite"),
    "inf": ("A1\tX\n1,5\t-inf\n", 2, "column X: '-inf' is not finite"),
    "huge": ("A1;X\n1,5;1e12\n", 2, "column X: 1e12 is too large"),
    "gap": ("A1;X\n;300\n", 2, "column A1: no value"),
    "short": ("A1;X\n1,5\n", 2, "the row has 1 value, the header 2 columns"),
    "long": ("A1;X\n1,5;2;3\n", 2, "the row has 3 values, the header 2 columns"),
    "twice": ("A1;X;a1\n1;2;3\n", 1, "columns 'A1' and 'a1' are the same: A1"),
    "two_separators": ("A1;X,B\n1;2\n", 1, "the header has semicolons and commas: one separates the columns"),
    "other_separator": ("sep=|\nA1|X\n1|2\n", 1, "the columns are separated by '|'; permitted: commas, semicolons"),
    "blanks": ("A1 X\n1 2\n", 1, "the columns are separated by blanks"),
    "radians": ("A1 [rad],X\n1,2\n", 1, "the values of axis A1 are in deg (1 rad is 57.29577951308232 deg)"),
    "metres": ("A1,X (m)\n1,2\n", 1, "the values of axis X are in mm (1 m is 1000 mm)"),
    "inches": ("A1,X [in]\n1,2\n", 1, "(1 in is 25.4 mm)"),
    "no_header": ("1,5;2\n3;4\n", 1, "the first line must name the columns"),
    "decimal_comma_between_commas": ("A1,X\n1,5,300\n", 2, "decimals are written with a point"),
    "comments_alone": ("# A1,X\n", 0, "the table is empty"),
}  # fmt: skip


@pytest.mark.parametrize(("content", "line", "text"), REFUSED.values(), ids=REFUSED)
def test_what_may_mean_two_things_is_refused(tmp_path: Path, content: str | bytes, line: int, text: str) -> None:
    path = written(tmp_path, content)
    with pytest.raises(TableError) as caught:
        read(path)
    assert text in str(caught.value)
    assert str(caught.value).startswith(f"{path}:{line}: " if line else f"{path}: ")


def test_marks_stand_under_the_field_between_semicolons(tmp_path: Path) -> None:
    with pytest.raises(TableError) as caught:
        read(written(tmp_path, "A1;X\n1,5;oops\n"))
    line, mark = caught.value.marked_line().split("\n")
    assert mark.index("^") == line.index("oops")


def packed(name: str) -> bytes:
    """Return a zip archive that holds one file."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(name, "A1,X\n1,2\n")
    return stream.getvalue()


OTHER_FILES = {
    "excel": (packed("xl/workbook.xml"), "this is an Excel workbook, no table", "CSV UTF-8"),
    "zip": (packed("table.csv"), "this is a zip archive, no table", "unpack it"),
    "gzip": (gzip.compress(COMMA.encode()), "this is a file compressed with gzip", "gunzip"),
    "old_excel": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(100), "an old Office file", "CSV UTF-8"),
    "pdf": (b"%PDF-1.7\n%\xe2\xe3\n", "this is a PDF", "a table of text"),
    "picture": (b"\x89PNG\r\n\x1a\n", "this is a picture (PNG)", "a table of text"),
}


@pytest.mark.parametrize(("content", "text", "hint"), OTHER_FILES.values(), ids=OTHER_FILES)
def test_other_files_are_called_by_their_name(tmp_path: Path, content: bytes, text: str, hint: str) -> None:
    with pytest.raises(TableError) as caught:
        read(written(tmp_path, content))
    assert text in str(caught.value)
    assert hint in str(caught.value)


def test_poses_and_recordings_have_the_same_habits(tmp_path: Path) -> None:
    columns = "X [mm];y (mm);Z_mm;A [deg];b [°];c_DEG"
    path = written(tmp_path, f"{columns}\n1000,5;0;-2;10,25;20;30\n")
    with PoseTable(path, PoseForm("orirpy")) as table:
        (row,) = table.rows()
    plain = written(tmp_path, "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1000.5,0,-2,10.25,20,30\n")
    with PoseTable(plain, PoseForm("orirpy")) as table:
        (same,) = table.rows()
    assert (row.T == same.T).all()
    chain = chainbuild.load("kr6r900").chain()
    path = written(tmp_path, f"A1;A2;A3;A4;A5;A6 [deg];{columns}\n0;-90;90;0;30;0;514,282;0;850,5;180;60;180\n")
    assert chainbuild.read_recording(path, chain).poses[0, :3, 3] == pytest.approx([0.514282, 0.0, 0.8505])


def test_a_pose_column_with_another_unit_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TableError, match=r"column 'x \[m\]': x_mm is in mm \(1 m is 1000 mm\); permitted: x_mm or x"):
        PoseTable(written(tmp_path, "x [m],y_mm,z_mm\n1,2,3\n"), PoseForm("orirpy", "position"))


def test_standard_input_is_a_table(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(SEMICOLON.encode("utf-16"))))
    assert read(Path("-")) == VALUES


def test_faults_of_standard_input_are_told_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"A1,X\n1,two\n")))
    with pytest.raises(TableError, match="standard input:2: column X: 'two' is not a number"):
        read(Path("-"))
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(FileAccessError, match="standard input is closed"):
        read(Path("-"))


@pytest.mark.parametrize("seed", range(40))
def test_bytes_of_any_kind_end_in_a_message(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    content = bytearray(SEMICOLON.encode(["utf-8", "utf-16"][seed % 2]))
    for place in rng.integers(0, len(content), 3):
        content[place] = rng.integers(0, 256)
    try:
        assert all(len(row) == len(AXES) for row in read(written(tmp_path, bytes(content))))
    except ChainbuildError as error:
        assert "table.csv" in str(error)


def test_a_linear_axis_in_a_table_of_poses_is_no_position(tmp_path: Path) -> None:
    form = PoseForm.of(chainbuild.load("ac_table_kin58").chain(), "pose")
    with pytest.raises(TableError, match=r"'X \[mm\]'.* X is an axis: the position of the tool is x_mm, y_mm"):
        PoseTable(written(tmp_path, "X [mm];Y [mm];Z [mm];A;C\n1;2;3;4;5\n"), form)
