"""Column names of a header: axes by any of their names, drives, other columns in any case."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from chainbuild.chain.elements import Axis
from chainbuild.errors import TableError
from chainbuild.tables.reader import Table

AXES = (
    replace(Axis.unlimited("X_BETT", "linear"), generic="X"),
    replace(Axis.unlimited("C_KOPF", "rotary"), generic="C"),
    replace(Axis.unlimited("C", "rotary"), generic="A"),
)


def names(folder: Path, header: str) -> tuple[str, ...]:
    """Return the names by which a table knows the columns of a header, whatever they are."""
    path = folder / "table.csv"
    path.write_text(f"{header}\n", "utf-8")
    with Table(path, lambda found: (found, found), AXES) as table:
        assert table.written == tuple(name.strip() for name in header.split(","))
        return table.names


@pytest.mark.parametrize(
    ("header", "known"),
    [
        ("X_BETT,C_KOPF,C", ("X_BETT", "C_KOPF", "C")),
        ("x,a,c_kopf", ("X_BETT", "C", "C_KOPF")),
        # C is the channel's third axis, not the one that the type calls so.
        ("C", ("C",)),
        ("c [deg]", ("C",)),
        (" X [mm] ,A[°], C_KOPF [ Degrees ]", ("X_BETT", "C", "C_KOPF")),
        ("X_MM,Qw,TOOL_z,A_Deg,STATUS,Ori_X,Position_Error_MM", (
            "x_mm", "qw", "tool_z", "a_deg", "status", "ori_x", "position_error_mm",
        )),
        ("X_drive,c_Drive,C_KOPF_DRIVE,Q_drive", ("X_BETT_drive", "C_drive", "C_KOPF_drive", "Q_drive")),
        ("B,[mm],X [mm] [mm],X]mm[", ("B", "[mm]", "X [mm] [mm]", "X]mm[")),
    ],
)  # fmt: skip
def test_what_columns_are_known_by(tmp_path: Path, header: str, known: tuple[str, ...]) -> None:
    assert names(tmp_path, header) == known


@pytest.mark.parametrize(
    ("header", "text"),
    [
        ("X_BETT,x", "columns 'X_BETT' and 'x' are the same: X_BETT"),
        ("c_kopf [deg],C_KOPF", "columns 'c_kopf [deg]' and 'C_KOPF' are the same: C_KOPF"),
        ("X_MM,x_mm", "columns 'X_MM' and 'x_mm' are the same: x_mm"),
        ("X_drive,X_BETT_drive", "columns 'X_drive' and 'X_BETT_drive' are the same: X_BETT_drive"),
        ("X,X", "column 'X' occurs twice"),
        ("X [deg]", "column 'X [deg]': the values of axis X_BETT are in mm; permitted: X_BETT or X_BETT [mm]"),
        ("A [mm]", "column 'A [mm]': the values of axis C are in deg"),
        ("X [m]", "the values of axis X_BETT are in mm"),
    ],
)
def test_what_is_refused(tmp_path: Path, header: str, text: str) -> None:
    with pytest.raises(TableError) as caught:
        names(tmp_path, f"Q,{header}")
    assert text in str(caught.value)
    assert caught.value.span is not None
    assert caught.value.span.column == len(f"Q,{header}".rpartition(",")[0]) + 2


def test_a_fault_of_a_row_names_the_column_as_written(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("c [deg]\nnone\n", "utf-8")
    with (
        pytest.raises(TableError, match=r"column c \[deg\]: 'none' is not a number"),
        Table(path, lambda found: (found, found), AXES) as table,
    ):
        list(table.chunks())
