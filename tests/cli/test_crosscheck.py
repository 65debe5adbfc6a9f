"""`chainbuild crosscheck`: solvers by name, functions, recordings; text, JSON, HTML; exit codes."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.comparison.samples import make_samples
from chainbuild.machines import shipped_path
from chainbuild.tables import PoseForm, PoseWriter
from tests.kit.command_line import Run
from tests.kit.paths import REFERENCE, ROOT, TESTS

ARM = "kr6r900_2"
TABLE = REFERENCE / "kin58_trt_2.lis"


def record(path: Path, there: chainbuild.Chain, shown: chainbuild.Chain, columns: tuple[str, ...]) -> None:
    """Write what a controller with one model would show, read by a machine with another."""
    robot = chainbuild.Robot(there)
    rows = make_samples(chainbuild.Robot(shown), 30, ("random",)).axes
    lines = [",".join((*(axis.name for axis in shown.axes), *columns))]
    with (path.parent / "poses.csv").open("w", encoding="utf-8") as stream:
        writer = PoseWriter(stream, PoseForm.of(shown, "pose"), quaternion=True, angles=shown.angle_mode)
        for row in rows:
            writer.write(robot.fk(row).homogeneous, robot.display(row))
    header, *written = (path.parent / "poses.csv").read_text("utf-8").splitlines()
    places = [header.split(",").index(column) for column in columns]
    for row, line in zip(rows, written, strict=True):
        lines.append(",".join((*map(repr, row.tolist()), *(line.split(",")[n] for n in places))))
    path.write_text("\n".join(lines) + "\n", "utf-8")


POSITION = ("x_mm", "y_mm", "z_mm")
ANGLES = ("a_deg", "b_deg", "c_deg")
VECTOR = ("tool_x", "tool_y", "tool_z")


@pytest.mark.parametrize(
    "columns", [POSITION, POSITION + ANGLES, POSITION + VECTOR, (*POSITION, "qx", "qy", "qz", "qw")]
)
def test_a_recording_that_agrees(run: Run, columns: tuple[str, ...]) -> None:
    chain = chainbuild.load(ARM).chain()
    record(Path("recorded.csv"), chain, chain, columns)
    outcome = run("crosscheck", ARM, "--recording", "recorded.csv")
    assert outcome.code == 0
    assert "30 of 30 poses agree within 0.01 mm" in outcome.out
    assert outcome.out.endswith("Result: agrees\n")


def test_a_recording_that_decides_a_convention(run: Run) -> None:
    machine = chainbuild.load(TABLE)
    record(
        Path("r.csv"),
        machine.chain(conventions={"table_rotary_sense": "left_handed"}),
        machine.chain(),
        POSITION + VECTOR,
    )
    outcome = run("crosscheck", TABLE, "--recording", "r.csv")
    assert outcome.code == 3
    assert "Conventions that would make it agree:" in outcome.out
    assert "table_rotary_sense=left_handed" in outcome.out
    data = json.loads(run("crosscheck", TABLE, "--recording", "r.csv", "--json").out)
    assert data["agrees"] is False
    assert {"table_rotary_sense": "left_handed"} in [trial["choices"] for trial in data["trials"] if trial["agrees"]]
    chosen = run("crosscheck", TABLE, "--recording", "r.csv", "--convention", "table_rotary_sense=left_handed")
    assert chosen.code == 0


def test_single_rows_that_differ_are_named(run: Run) -> None:
    chain = chainbuild.load(ARM).chain()
    record(Path("r.csv"), chain, chain, POSITION + ANGLES)
    header, *rows = Path("r.csv").read_text("utf-8").splitlines()
    for place in (6, 19):
        values = rows[place].split(",")
        rows[place] = ",".join([*values[:4], repr(float(values[4]) + place), *values[5:]])
    Path("r.csv").write_text("\n".join([header, *rows]) + "\n", "utf-8")
    outcome = run("crosscheck", ARM, "--recording", "r.csv", "--html", "r.html")
    assert outcome.code == 3
    lines = [line.strip() for line in outcome.out.splitlines()]
    assert lines[1].startswith("Forward: 28 of 30 poses agree")
    assert "at row 20: C1 " in lines[2]
    assert lines[3] == "differing: rows 7, 20"
    assert lines[4] == "theirs minus ours, in the workpiece frame:"
    assert lines[5].split() == ["row", "dx_mm", "dy_mm", "dz_mm"]
    assert [line.split()[0] for line in lines[6:8]] == ["7", "20"]
    assert lines[8] == "Structure: none found; most poses agree: check those that differ"
    largest = Path("r.html").read_text("utf-8").partition("Largest errors")[2]
    assert largest.index("<td>20</td>") < largest.index("<td>7</td>")


def test_two_rows_are_too_few_to_name_anything(run: Run) -> None:
    chain = chainbuild.load(ARM).chain()
    record(Path("r.csv"), chain, chain, POSITION + ANGLES)
    header, *rows = Path("r.csv").read_text("utf-8").splitlines()
    moved = [",".join([repr(float(row.split(",")[0]) + 1.0), *row.split(",")[1:]]) for row in rows]
    for count, named in ((2, "needs at least 3 poses: record more"), (3, "the zero of C1 is off by -1 deg")):
        Path("r.csv").write_text("\n".join([header, *moved[:count]]) + "\n", "utf-8")
        assert named in run("crosscheck", ARM, "--recording", "r.csv").out


def test_many_rows_that_differ_are_counted(run: Run) -> None:
    chain = chainbuild.load(ARM).chain()
    record(Path("r.csv"), chain, chain, POSITION)
    header, *rows = Path("r.csv").read_text("utf-8").splitlines()
    rows[:14] = [",".join([f"{float(row.split(',')[0]) + 1}", *row.split(",")[1:]]) for row in rows[:14]]
    Path("r.csv").write_text("\n".join([header, *rows]) + "\n", "utf-8")
    out = run("crosscheck", ARM, "--recording", "r.csv").out
    assert "  differing: rows 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, … (14 in all)\n" in out


def test_a_tool_length_is_named(run: Run) -> None:
    machine = chainbuild.load(TABLE)
    record(Path("r.csv"), machine.chain(tool_length_mm=37.5), machine.chain(), POSITION + VECTOR)
    outcome = run("crosscheck", TABLE, "--recording", "r.csv")
    assert outcome.code == 3
    # On a table machine the zero of Z cannot be told from the length of the tool: both are named.
    assert "(0, 0, -37.5) mm in the tool frame" in outcome.out
    assert "the zero of Z is off by -37.5 mm" in outcome.out
    assert "not distinguishable at these poses: " in outcome.out
    assert run("crosscheck", TABLE, "--recording", "r.csv", "--tool-length", "37.5").code == 0


def test_a_solver_by_name(run: Run) -> None:
    outcome = run("crosscheck", ARM, "--solver", "opw", "--count", "45", "--samples", "singular", "--seed", "2")
    assert outcome.code == 0
    assert "45 of 45 poses agree" in outcome.out
    assert "0 wrong" in outcome.out
    assert "missing in theirs: 0; extra in theirs: 0" in outcome.out


def test_a_function_of_the_users_folder(run: Run) -> None:
    Path("my_solver_of_this_test.py").write_text(
        "import numpy as np\n"
        "import chainbuild\n"
        f"robot = chainbuild.Robot.load({ARM!r})\n"
        "def fk(axes):\n"
        "    return robot.fk(axes * np.array([1, 1, 1, -1, 1, 1])).homogeneous\n"
        "def ik(T):\n"
        "    return [branch.axes for branch in robot.ik_all(T)]\n",
        "utf-8",
    )
    outcome = run("crosscheck", ARM, "--solver", "my_solver_of_this_test:fk", "--count", "30")
    assert outcome.code == 3
    assert "Structure: flipped axis: A1 counted in the opposite direction" in outcome.out
    assert run("crosscheck", ARM, "--solver", "my_solver_of_this_test:ik", "--count", "30").code == 0
    assert run("crosscheck", ARM, "--solver", "my_solver_of_this_test:nothing").code == 1


class _Page(HTMLParser):
    """Counts the elements of a page and collects its text."""

    def __init__(self) -> None:
        super().__init__()
        self.counts: dict[str, int] = {}
        self.text = ""
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.counts[tag] = self.counts.get(tag, 0) + 1
        self.links += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data: str) -> None:
        self.text += data


def test_the_page_stands_alone(run: Run) -> None:
    machine = chainbuild.load(TABLE)
    record(Path("r.csv"), machine.chain(tool_length_mm=37.5), machine.chain(), (*POSITION, "qx", "qy", "qz", "qw"))
    outcome = run("crosscheck", TABLE, "--recording", "r.csv", "--html", "page.html")
    assert outcome.code == 3
    assert "wrote page.html" in outcome.err
    page = _Page()
    page.feed(Path("page.html").read_text("utf-8"))
    assert page.links == []
    assert page.counts["svg"] == 2 * (1 + 5)  # position and rotation: a histogram, and a plot an axis
    assert page.counts["circle"] == 2 * 5 * 30
    assert "offset on the tool side" in page.text
    assert "Largest errors" in page.text


def test_json_holds_every_row(run: Run) -> None:
    data = json.loads(run("crosscheck", ARM, "--solver", "eaik", "--count", "30", "--json").out)
    assert data["agrees"] is True
    rows = data["forward"]["rows"]
    assert len(rows) == data["forward"]["poses"]
    assert len(rows[0]["axes"]) == 6
    assert max(row["position_error_mm"] for row in rows) < 1e-9
    assert data["inverse"]["missing"] == 0
    assert np.isfinite(data["inverse"]["worst_position_error_mm"])


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        ((), 2, "either --solver or --recording"),
        (("--solver", "opw", "--recording", "x.csv"), 2, "either --solver or --recording"),
        (("--solver", "best"), 1, "unknown solver 'best'"),
        (("--recording", "absent.csv"), 1, "absent.csv"),
        (("--solver", "opw", "--position-tolerance", "0"), 1, "tolerance"),
        (("--solver", "opw", "--samples", "all"), 2, "all"),
        (("--solver", "opw", "--count", "0"), 1, "no samples requested"),
    ],
)
def test_bad_requests(run: Run, words: tuple[str, ...], code: int, text: str) -> None:
    outcome = run("crosscheck", ARM, *words)
    assert outcome.code == code
    assert text in outcome.err


@pytest.mark.parametrize(
    ("content", "text"),
    [
        ("C1,B1,B2,A1,B3,A2,x_mm,y_mm,z_mm\n", "the recording has no rows"),
        ("C1,B1,B2,A1,B3,x_mm,y_mm,z_mm\n1,2,3,4,5,6,7,8\n", "missing column A2"),
        ("C1,B1,B2,A1,B3,A2,x_mm,y_mm\n1,2,3,4,5,6,7,8\n", "missing column z_mm"),
        (
            "C1,B1,B2,A1,B3,A2,x_mm,y_mm,z_mm,tool_x,tool_y,tool_z\n1,2,3,4,5,6,7,8,9,0,0,0\n",
            "tool_z) has the length 0",
        ),
        ("C1,B1,B2,A1,B3,A2,x_mm,y_mm,z_mm,colour\n1,2,3,4,5,6,7,8,9,1\n", "unknown column 'colour'"),
    ],
)
def test_bad_recordings(run: Run, content: str, text: str) -> None:
    Path("bad.csv").write_text(content, "utf-8")
    outcome = run("crosscheck", ARM, "--recording", "bad.csv")
    assert outcome.code == 1
    assert text in outcome.err


GANTRY = "trafo[0].id 9\ntrafo[0].param[0] 1800000\ntrafo[0].param[1] 3000000\ntrafo[0].param[4] {}\nEnde\n"


@pytest.mark.parametrize("columns", [POSITION, POSITION + VECTOR])
def test_a_wrong_datum_of_a_head_is_named(run: Run, columns: tuple[str, ...]) -> None:
    for name, value in (("here", -400000), ("there", 400000)):
        Path(f"{name}.lis").write_text(GANTRY.format(value), "utf-8")
    here, there = (chainbuild.load(f"{name}.lis").chain() for name in ("here", "there"))
    record(Path("r.csv"), there, here, columns)
    outcome = run("crosscheck", "here.lis", "--recording", "r.csv", "--html", "r.html")
    assert outcome.code == 3
    line = next(line for line in outcome.out.splitlines() if "HD5" in line).strip()
    assert line.startswith("HD5 trafo[0].param[4] (line 4): -40 to 40 mm, in the list 400000 (leaves ")
    assert "no single change" not in outcome.out
    head, first = (outcome.out.splitlines()[n].split() for n in (5, 6))
    assert head == ["row", "dx_mm", "dy_mm", "dz_mm"]
    if columns == POSITION:
        return
    data = json.loads(run("crosscheck", "here.lis", "--recording", "r.csv", "--json").out)
    # The head turned over shows the same: two changes, so the one datum is named first.
    assert data["structure"]["kind"] == "flipped axis + axis zero"
    assert outcome.out.index("Machine data that would") < outcome.out.index("Structure: ")
    assert "two axes swapped" in data["tried"]
    (found,) = data["data"]
    (value,) = found["values"]
    assert (value["name"], value["symbol"], value["line"]) == ("trafo[0].param[4]", "HD5", 4)
    assert (value["old"], value["new"], value["unit"]) == (-40.0, 40.0, "mm")
    row = data["forward"]["rows"][0]
    moved = [row[name] for name in ("dx_mm", "dy_mm", "dz_mm")]
    assert np.linalg.norm(moved) == pytest.approx(row["position_error_mm"], abs=1e-9)
    assert [f"{value + 0.0:+.3f}" for value in np.round(moved, 3)] == first[1:]
    page = Path("r.html").read_text("utf-8")
    assert "<th>dx_mm</th><th>dy_mm</th><th>dz_mm</th>" in page


def test_the_changes_tried_are_listed_where_none_explains(run: Run) -> None:
    chain = chainbuild.load(TABLE).chain()
    record(Path("r.csv"), chain, chain, POSITION)
    header, *rows = Path("r.csv").read_text("utf-8").splitlines()
    noise = np.random.default_rng(4).normal(size=(len(rows), 3))
    places = [row.split(",") for row in rows]
    for row, shift in zip(places, noise, strict=True):
        row[-3:] = [repr(float(value) + moved) for value, moved in zip(row[-3:], shift.tolist(), strict=True)]
    Path("r.csv").write_text("\n".join([header, *(",".join(row) for row in places)]) + "\n", "utf-8")
    out = run("crosscheck", TABLE, "--recording", "r.csv").out
    assert "Structure: none found\n  tried: up to 3 axes reversed; two axes swapped; " in out
    assert "the zero of each axis" in out
    assert "Machine data tried one by one, none agrees; the best:\n" in out


def test_the_readme_names_a_reversed_axis_from_six_rows(run: Run) -> None:
    path = shipped_path("comau_calibrated")
    assert path is not None
    recording = TESTS / "data" / "recordings" / "comau_calibrated.csv"
    assert run("crosscheck", "comau_calibrated", "--recording", recording).code == 0
    text = path.read_text("utf-8").replace("AXES_DIR[2]=-1", "AXES_DIR[2]=1")
    Path("arm.tea").write_text(text, "utf-8")
    lines = run("crosscheck", "arm.tea", "--recording", recording).out.splitlines()
    start = next(n for n, line in enumerate(lines) if line.startswith("Structure"))
    assert len(lines[start:]) == 4
    assert "\n".join(lines[start:]) in (ROOT / "README.md").read_text("utf-8")
