"""CSV tables: columns by name, faults with line and column, full precision, constant memory."""

from __future__ import annotations

import io
import math
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import frames
from chainbuild.chain.elements import Axis, Task
from chainbuild.chain.programmed.display import Display
from chainbuild.errors import FileAccessError, TableError
from chainbuild.tables import AxisTable, IkWriter, PoseForm, PoseTable, PoseWriter

POSE_COLUMNS = (
    *("x_mm", "y_mm", "z_mm"),
    *("qx", "qy", "qz", "qw"),
    *("tool_x", "tool_y", "tool_z"),
    *("a_deg", "b_deg", "c_deg"),
)
C_ALONE = Display(columns=("c_deg",))
AXES = (Axis.unlimited("A1", "rotary"), Axis.unlimited("A2", "rotary"), Axis.unlimited("X", "linear"))


def write(folder: Path, content: str | bytes) -> Path:
    path = folder / "table.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def read_axes(path: Path) -> list[list[float]]:
    with AxisTable(path, AXES) as table:
        return [values.tolist() for _, values in table.rows()]


def read_poses(path: Path, task: Task = "pose", mode: str = "orirpy") -> list[np.ndarray]:
    with PoseTable(path, PoseForm(mode, task)) as table:
        return [row.T for row in table.rows()]


@pytest.mark.parametrize(
    "content",
    [
        "A1,A2,X\n1,-2.5,3e2\n",
        "X,A1,A2\n300,1,-2.5\n",
        "A1,A2,X\r\n1,-2.5,3e2\r\n",
        "A1,A2,X\r1,-2.5,3e2\r",
        b"\xef\xbb\xbfA1,A2,X\n1,-2.5,3e2\n",
        "\nA1 , A2,X\n\n 1 ,-2.5,+300.0\n\n",
        '"A1","A2","X"\n"1","-2.5","300"\n',
        "A1,A2,X\n1,-2.5,3e2",
        "A1,status,A2,X,position_error_mm,rotation_error_deg\n1,ok,-2.5,300,0.1,\n",
    ],
)
def test_accepted_spellings(tmp_path: Path, content: str | bytes) -> None:
    assert read_axes(write(tmp_path, content)) == [[1.0, -2.5, 300.0]]


def test_a_header_alone_is_an_empty_table(tmp_path: Path) -> None:
    assert read_axes(write(tmp_path, "A1,A2,X\n")) == []


BAD = {
    "empty": ("", 0, "empty"),
    "blank": ("\n \n", 0, "empty"),
    "missing": ("A1,X\n1,2\n", 1, "missing column A2; permitted: A1, A2, X"),
    "two_missing": ("A1\n1\n", 1, "missing columns A2, X"),
    "unknown": ("A1,A2,X,B7\n1,2,3,4\n", 1, "unknown column 'B7'; permitted: A1, A2, X"),
    "unit": ("A1 [mm],A2,X\n1,2,3\n", 1, "the values of axis A1 are in deg; permitted: A1 or A1 [deg]"),
    "no_unit": ("A1,A2,X []\n1,2,3\n", 1, "column 'X []': the values of axis X are in mm; permitted: X or X [mm]"),
    "same": ("A1,A2,X,a1 [deg]\n1,2,3,4\n", 1, "columns 'A1' and 'a1 [deg]' are the same: A1"),
    "no_header": ("1,2,3\n1,2,3\n", 1, "first line must name the columns"),
    "nameless": ("A1,,A2,X\n1,,2,3\n", 1, "column 2 has no name"),
    "double": ("A1,A2,X,A1\n1,2,3,4\n", 1, "column 'A1' occurs twice"),
    "blanks": ("A1 A2 X\n1 2 3\n", 1, "separated by blanks; permitted: commas, semicolons or tabs"),
    "decimal_comma": ("A1,A2,X\n1,2,3\n1,5,2,3\n", 3, "decimals are written with a point"),
    "quoted_comma": ('A1,A2,X\n"1,5",2,3\n', 2, "'1,5' is not a number: decimals are written with a point"),
    "row_semicolon": ("A1,A2,X\n1,2;5,3\n", 2, "column A2: '2;5' is not a number"),
    "short": ("A1,A2,X\n1,2\n", 2, "the row has 2 values, the header 3 columns"),
    "long": ("A1,A2,X\n1,2,3,,4\n", 2, "the row has 5 values"),
    "no_value": ("A1,A2,X\n1,,3\n", 2, "column A2: no value"),
    "quoted_error": ('A1,A2,X\n"#REF!",2,3\n', 2, "#REF!"),
    "words": ("A1,A2,X\n1,two,3\n", 2, "column A2: 'two' is not a number"),
    "nan": ("A1,A2,X\n1,2,3\n\n1,2,nan\n", 4, "column X: 'nan' is not finite"),
    "inf": ("A1,A2,X\n-inf,2,3\n", 2, "column A1: '-inf' is not finite"),
    "infinity": ("A1,A2,X\nInfinity,2,3\n", 2, "column A1: 'Infinity' is not finite"),
    "overflow": ("A1,A2,X\n1e999,2,3\n", 2, "column A1: '1e999' is not finite"),
    "huge": ("A1,A2,X\n1,2,1e12\n", 2, "column X: 1e12 is too large"),
    "underscore": ("A1,A2,X\n1_0,2,3\n", 2, "'1_0' is not a number"),
    "other_digits": ("A1,A2,X\n１,2,3\n", 2, "'１' is not a number"),
    "hex": ("A1,A2,X\n0x10,2,3\n", 2, "'0x10' is not a number"),
    "nul": (b"A1,A2,X\n1,\x00,3\n", 2, "is not a number"),
    "open_quote": ('A1,A2,X\n1,"2,3\n', 2, "is not valid CSV"),
    "latin_1": (b"A1,A2,X\n1,2,3\n1,\xe4,3\n", 3, "column A2: 'ä' is not a number"),
    "half_utf_16": ("A1,A2,X\n1,2,3\n".encode("utf-16")[:-1], 2, "not UTF-16 to its end"),
    "long_line": ("A1,A2,X\n" + "1" * 200_000, 2, "too long"),
}


@pytest.mark.parametrize(("content", "line", "message"), BAD.values(), ids=BAD)
def test_bad_tables_are_refused_with_their_line(tmp_path: Path, content: str | bytes, line: int, message: str) -> None:
    path = write(tmp_path, content)
    with pytest.raises(TableError) as caught:
        read_axes(path)
    assert message in str(caught.value)
    assert str(caught.value).startswith(f"{path}:{line}: " if line else f"{path}: ")
    assert "\n    " not in caught.value.message


def test_the_mark_stands_under_the_field(tmp_path: Path) -> None:
    with pytest.raises(TableError) as caught:
        read_axes(write(tmp_path, "A1,A2,X\n10,20,oops\n"))
    line, mark = caught.value.marked_line().split("\n")
    assert mark.index("^") == line.index("oops")


@pytest.mark.parametrize("name", ["missing.csv", ".", "nul\0byte"])
def test_files_that_cannot_be_read(tmp_path: Path, name: str) -> None:
    with pytest.raises(FileAccessError):
        read_axes(tmp_path / name)


POSITION = "x_mm,y_mm,z_mm"
R = frames.matrix_from_angles("orirpy", (10.0, 20.0, 30.0))
QUATERNION = ",".join(map(repr, frames.quaternion_from_matrix(R)))


def test_orientation_from_quaternion_or_angles(tmp_path: Path) -> None:
    one = read_poses(write(tmp_path, f"{POSITION},qx,qy,qz,qw\n1000,0,-2,{QUATERNION}\n"))[0]
    two = read_poses(write(tmp_path, f"c_deg,b_deg,a_deg,{POSITION}\n30,20,10,1000,0,-2\n"))[0]
    for T in (one, two):
        assert np.abs(T - frames.transform(R, (1.0, 0.0, -0.002))).max() < 1e-15


def test_a_quaternion_wins_and_other_columns_are_not_read(tmp_path: Path) -> None:
    header = f"{POSITION},qx,qy,qz,qw,tool_x,tool_y,tool_z,a_deg,b_deg,c_deg"
    T = read_poses(write(tmp_path, f"{header}\n0,0,0,{QUATERNION},x,,nan,99,,inf\n"))[0]
    assert np.abs(T[:3, :3] - R).max() < 1e-15


def test_rounded_quaternions_are_normalised(tmp_path: Path) -> None:
    T = read_poses(write(tmp_path, f"{POSITION},qx,qy,qz,qw\n0,0,0,0,0,0.7071,-0.7071\n"))[0]
    assert np.abs(T[:3, :3] - frames.rot_z(-90.0)).max() < 1e-15


BAD_POSES = {
    "no_orientation": (f"{POSITION}\n1,2,3\n", "pose", "missing columns a_deg, b_deg, c_deg, or qx"),
    "tool_vector": (
        f"{POSITION},tool_x,tool_y,tool_z\n1,2,3,0,0,1\n",
        "pose",
        "missing columns a_deg, b_deg, c_deg, or qx",
    ),
    "half_a_quaternion": (f"{POSITION},qx,qy,qz,a_deg,b_deg,c_deg\n1,2,3,0,0,0,0,0,0\n", "pose", "missing column qw"),
    "two_angles": (f"{POSITION},a_deg,b_deg\n1,2,3,0,0\n", "pose", "missing column c_deg"),
    "no_position": ("x_mm,y_mm,qx,qy,qz,qw\n1,2,0,0,0,1\n", "pose", "missing column z_mm"),
    "norm": (f"{POSITION},qx,qy,qz,qw\n1,2,3,0,0,0.1,1\n", "pose", "has the length 1.00499; permitted: 1 ± 0.001"),
    "zero": (f"{POSITION},qx,qy,qz,qw\n1,2,3,0,0,0,0\n", "pose", "has the length 0"),
    "short_vector": (f"{POSITION},tool_x,tool_y,tool_z\n1,2,3,0,0,0.5\n", "direction", "has the length 0.5"),
    "half_a_vector": (f"{POSITION},tool_x,tool_z\n1,2,3,0,1\n", "position", "missing column tool_y"),
    "direction_without": (f"{POSITION}\n1,2,3\n", "direction", "missing columns a_deg"),
    "axis_column": (f"{POSITION},A1\n1,2,3,0\n", "pose", "unknown column 'A1'"),
}


@pytest.mark.parametrize(("content", "task", "message"), BAD_POSES.values(), ids=BAD_POSES)
def test_bad_poses_are_refused(tmp_path: Path, content: str, task: Task, message: str) -> None:
    with pytest.raises(TableError) as caught:
        read_poses(write(tmp_path, content), task)
    assert message in str(caught.value)
    assert caught.value.line in (1, 2)


def test_c_alone_where_a_and_b_follow(tmp_path: Path) -> None:
    path = write(tmp_path, f"{POSITION},c_deg\n1,2,3,700\n")
    with PoseTable(path, PoseForm("orirpy", "pose", C_ALONE, C_ALONE.columns)) as table:
        (row,) = table.rows()
    assert row.c_deg is None
    assert np.abs(row.T[:3, :3] - frames.rot_x(700.0)).max() < 1e-12
    with pytest.raises(TableError, match="a_deg, b_deg"):
        PoseTable(path, PoseForm("orirpy", "pose"))


@pytest.mark.parametrize("orientation", ["qx,qy,qz,qw,c_deg", "c_deg", "b_deg,c_deg,a_deg"])
def test_c_is_kept_where_it_runs_on(tmp_path: Path, orientation: str) -> None:
    values = {"qx": 0, "qy": 0, "qz": 0, "qw": 1, "a_deg": 0, "b_deg": 0, "c_deg": 720}
    fields = ",".join(str(values[name]) for name in orientation.split(","))
    path = write(tmp_path, f"{POSITION},{orientation}\n1,2,3,{fields}\n")
    with PoseTable(path, PoseForm("orirpy", "pose", C_ALONE, C_ALONE.columns, running_c=True)) as table:
        (row,) = table.rows()
        assert table.by_quaternion == orientation.startswith("q")
    assert row.c_deg == 720.0
    assert np.abs(row.T[:3, :3] - np.eye(3)).max() < 1e-12


def test_a_tool_vector_along_x(tmp_path: Path) -> None:
    path = write(tmp_path, f"{POSITION},tool_x,tool_y,tool_z\n0,0,0,-0.48,0.64,-0.6\n")
    with PoseTable(path, PoseForm("orirpy", "direction", tool_axis="x")) as table:
        (row,) = table.rows()
    assert np.abs(row.T[:3, 0] - (-0.48, 0.64, -0.6)).max() < 1e-12


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.6, 0.0, 0.8), (-0.48, 0.64, -0.6)])
@pytest.mark.parametrize("task", ["direction", "position"])
def test_a_tool_vector_is_enough_for_fewer_freedoms(tmp_path: Path, direction: tuple[float, ...], task: Task) -> None:
    header = f"{POSITION},tool_x,tool_y,tool_z"
    T = read_poses(write(tmp_path, f"{header}\n1,2,3,{','.join(map(str, direction))}\n"), task)[0]
    assert np.abs(T[:3, 2] - direction).max() < 1e-15
    assert np.abs(T[:3, :3] @ T[:3, :3].T - np.eye(3)).max() < 1e-15


def test_a_position_is_enough_where_nothing_else_can_be_met(tmp_path: Path) -> None:
    with PoseTable(write(tmp_path, f"{POSITION}\n1,2,3\n"), PoseForm("orirpy", "position")) as table:
        assert not table.oriented
        assert [row.T[:3, 3].tolist() for row in table.rows()] == [[0.001, 0.002, 0.003]]


@pytest.mark.parametrize("mode", ["orirpy", "orirpy2", "ypr", "euler_a_first", "cba", "cab", "abc"])
def test_poses_read_back_within_the_digits_written(tmp_path: Path, mode: str) -> None:
    rng = np.random.default_rng(5)
    poses = [
        frames.transform(frames.matrix_from_angles("cab", rng.uniform(-180, 180, 3).tolist()), rng.uniform(-3, 3, 3))
        for _ in range(200)
    ]
    text = io.StringIO()
    writer = PoseWriter(text, PoseForm(mode))
    for T in poses:
        writer.write(T)
    lines = text.getvalue().splitlines()
    assert lines[0].split(",") == list(POSE_COLUMNS)
    table = np.array([[float(field) for field in line.split(",")] for line in lines[1:]])
    assert (table[:, 6] >= 0.0).all()
    assert np.abs(table[:, 7:10] - [T[:3, 2] for T in poses]).max() <= 1e-15
    path = write(tmp_path, text.getvalue())
    for T, back in zip(poses, read_poses(path, mode=mode), strict=True):
        assert np.abs(back - T).max() <= 4e-15
    angles_only = [",".join([*line.split(",")[:3], *line.split(",")[10:]]) for line in lines]
    for T, back in zip(poses, read_poses(write(tmp_path, "\n".join(angles_only)), mode=mode), strict=True):
        assert np.abs(back - T).max() <= 3e-14


def test_axis_values_read_back_to_twelve_decimals(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    rows = rng.uniform(-400.0, 400.0, (100, 3))
    text = io.StringIO()
    writer = IkWriter(text, AXES)
    for row in rows:
        writer.write(row, "ok", 1e-7, 0.0)
    assert np.abs(np.array(read_axes(write(tmp_path, text.getvalue()))) - rows).max() <= 1e-12


def test_a_failed_row_keeps_status_and_errors_and_leaves_the_axes_empty() -> None:
    text = io.StringIO()
    writer = IkWriter(text, AXES)
    writer.write(None, "limits", 0.5, -0.0)
    writer.write(np.array([1.0, -0.0, 2.0]), "ok", 0.0, None)
    assert text.getvalue().splitlines() == [
        "A1,A2,X,status,position_error_mm,rotation_error_deg",
        ",,,limits,0.5,0.0",
        "1.0,0.0,2.0,ok,0.0,",
    ]


def stream_through(path: Path, rows: int) -> int:
    """Write and read a table of many rows; return the peak of memory in bytes."""
    with path.open("w", encoding="utf-8") as stream:
        stream.write("A1,A2,X\n")
        for n in range(rows):
            stream.write(f"{math.sin(n)!r},{n / 7!r},{n}\n")
    tracemalloc.start()
    try:
        with AxisTable(path, AXES) as table:
            count = sum(1 for _ in table.rows())
            assert table.position == table.size
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert count == rows
    return peak


def test_memory_does_not_grow_with_the_table(tmp_path: Path) -> None:
    small, large = (stream_through(tmp_path / f"{rows}.csv", rows) for rows in (2_000, 20_000))
    assert large < 1.2 * small
    assert large < 2_000_000


@pytest.mark.slow
def test_a_million_rows_stream_in_constant_memory(tmp_path: Path) -> None:
    assert stream_through(tmp_path / "million.csv", 1_000_000) < 2_000_000


def test_violations_have_a_column_where_they_are_asked_for() -> None:
    text = io.StringIO()
    writer = PoseWriter(text, PoseForm("orirpy", tool_axis="x"), violations=True)
    shown = {"a_deg": 1.0, "b_deg": 2.0, "c_deg": 900.0}
    writer.write(np.eye(4), shown, violated=("A1", "parallelogram angle"))
    writer.write(np.eye(4))
    head, first, second = text.getvalue().splitlines()
    assert head.endswith("c_deg,violations")
    assert first.endswith("1.0,0.0,0.0,1.0,2.0,900.0,A1; parallelogram angle")
    assert second.endswith("0.0,0.0,0.0,")
    text = io.StringIO()
    IkWriter(text, AXES, violations=True).write(None, "limits", 0.0, 0.0, ("parallelogram angle",))
    assert text.getvalue().splitlines()[0].endswith("rotation_error_deg,violations")
    assert text.getvalue().splitlines()[1].endswith("limits,0.0,0.0,parallelogram angle")


def test_numbers_are_written_without_noise_and_without_signed_zero() -> None:
    """What is left of exact values after a few products: 1e-30, the last bit of a length, -180 degrees."""
    T = frames.transform(frames.rot_z(180.0), (1.7650000000000002, -1e-33, -2.3e-17))
    T[0, 1], T[1, 0], T[2, 0] = -6.1e-17, 1.2e-16, -1e-17
    text = io.StringIO()
    PoseWriter(text, PoseForm("cba"), more=("EX1", "EW1")).write(T, more=(-0.0, 10.000000000000002))
    PoseWriter(text, PoseForm("cba")).write(frames.transform(frames.rot_z(-180.0 + 4e-13)))
    lines = text.getvalue().splitlines()
    assert lines[1] == "1765.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,180.0,0.0,0.0,0.0,10.0"
    assert lines[3].split(",")[10] == "180.0"
    text = io.StringIO()
    IkWriter(text, AXES).write(np.array([-2.3e-14, 1765.0000000000002, -90.00000000000001]), "ok", 1e-30, 1e-15)
    assert text.getvalue().splitlines()[1] == "0.0,1765.0,-90.0,ok,0.0,0.0"


def test_angles_that_contradict_the_quaternion_are_told(tmp_path: Path) -> None:
    header = f"{POSITION},qx,qy,qz,qw,a_deg,b_deg,c_deg"
    rows = ("10,20,30", "370,20,-330", "-170,160,-150", "10.04,20,30", "10.06,20,30", "99,20,30", "99,,nan")
    path = write(tmp_path, f"{header}\n" + "".join(f"0,0,0,{QUATERNION},{angles}\n" for angles in rows))
    with PoseTable(path, PoseForm("orirpy", "pose")) as table:
        read = list(table.rows())
    assert [row.contradictory for row in read] == [False, False, False, False, True, True, False]
    assert all(np.abs(row.T[:3, :3] - R).max() < 1e-15 for row in read)


def test_input_axes_have_columns_of_their_own(tmp_path: Path) -> None:
    text = io.StringIO()
    form = PoseForm("orirpy", held=("EX1", "EW1"))
    writer = PoseWriter(text, form, more=form.held, violations=True)
    writer.write(np.eye(4), None, (800.0, -5.0), violated=("A1",))
    head, row = text.getvalue().splitlines()
    assert head.endswith("c_deg,EX1,EW1,violations")
    assert row.endswith("0.0,800.0,-5.0,A1")
    with PoseTable(write(tmp_path, text.getvalue()), form) as table:
        assert [one.held for one in table.rows()] == [{"EX1": 800.0, "EW1": -5.0}]
    path = write(tmp_path, f"EW1,{POSITION},qx,qy,qz,qw\n7,1,2,3,0,0,0,1\n")
    with PoseTable(path, form) as table:
        assert [one.held for one in table.rows()] == [{"EW1": 7.0}]
    with pytest.raises(TableError, match="unknown column 'EW1'"):
        PoseTable(path, PoseForm("orirpy", "pose"))


@pytest.mark.parametrize(
    ("form", "end"),
    [
        (PoseForm("orirpy"), "missing columns a_deg, b_deg, c_deg, or qx, qy, qz, qw"),
        (PoseForm("orirpy", "pose", C_ALONE, C_ALONE.columns), "missing column c_deg, or qx, qy, qz, qw"),
        (
            PoseForm("orirpy", "direction"),
            "missing columns a_deg, b_deg, c_deg, or qx, qy, qz, qw, or tool_x, tool_y, tool_z",
        ),
    ],
)
def test_a_missing_orientation_names_all_that_would_do(tmp_path: Path, form: PoseForm, end: str) -> None:
    path = write(tmp_path, f"{POSITION}\n1,2,3\n")
    with pytest.raises(TableError) as caught:
        PoseTable(path, form)
    assert caught.value.message == end


@pytest.mark.parametrize(("name", "meant"), [("x", "x_mm"), ("A_DEGS", "a_deg"), ("qWW", "qw"), ("tool_xx", "tool_x")])
def test_an_unknown_pose_column_names_the_nearest(tmp_path: Path, name: str, meant: str) -> None:
    with pytest.raises(TableError, match=f"did you mean {meant}\\?"):
        PoseTable(write(tmp_path, f"{name}\n1\n"), PoseForm("orirpy"))


def test_an_unknown_axis_column_names_the_nearest_and_axes_only(tmp_path: Path) -> None:
    with pytest.raises(TableError) as caught:
        read_axes(write(tmp_path, "RA1,A2,X\n1,2,3\n"))
    assert str(caught.value).endswith("unknown column 'RA1'; permitted: A1, A2, X; did you mean A1?")


def test_a_recording_is_read_from_a_path_or_its_name(tmp_path: Path) -> None:
    path = tmp_path / "recorded.csv"
    path.write_text("A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm,status,violations\n0,-90,90,0,30,0,514.282,0,850,ok,\n")
    chain = chainbuild.load("kr6r900").chain()
    for given in (path, str(path)):
        found = chainbuild.read_recording(given, chain)
        assert found.axes.tolist() == [[0, -90, 90, 0, 30, 0]]
        assert found.poses[0, :3, 3] == pytest.approx([0.514282, 0.0, 0.85])
