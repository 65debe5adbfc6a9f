"""The report of a machine as a whole: its files, the same every time, and what stands in its chapters."""

from __future__ import annotations

import re
import shutil
import xml.etree.ElementTree as ET
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.axismap import AffineMap
from chainbuild.comparison.convention_trials import Selection
from chainbuild.errors import ChainbuildError, FileAccessError
from chainbuild.machines import shipped_path
from chainbuild.robot import Robot
from chainbuild.writers.machine_report import report as module
from chainbuild.writers.machine_report.axes import axes_chapter
from chainbuild.writers.machine_report.choices import conventions_chapter
from chainbuild.writers.machine_report.document.blocks import (
    Bullets,
    Chapter,
    Heading,
    Paragraph,
    Report,
    TableBlock,
    Verbatim,
)
from chainbuild.writers.machine_report.document.markdown import markdown_text
from chainbuild.writers.machine_report.document.page import page_text
from chainbuild.writers.machine_report.given import DataSource, data_chapter
from chainbuild.writers.machine_report.reach import reach_chapter
from chainbuild.writers.machine_report.report import machine_report, report_files
from chainbuild.writers.machine_report.singular import singular_chapter

FEW = ["ac_table_kin58", "scara_kin36", "kr6r900", "lambda_kin21"]
CHAPTERS = [
    "Machine", "Pictures", "Findings", "What the manuals leave open", "What the file says", "Axes, limits and drives",
    "Reach", "Singular positions", "Check poses", "Denavit-Hartenberg parameters", "Product of exponentials",
]  # fmt: skip


@cache
def report(name: str) -> Report:
    machine = chainbuild.load(name)
    return machine_report(Robot(machine.chain()), machine, None)


def chapter(name: str, title: str) -> Chapter:
    return next(one for one in report(name).chapters if one.title == title)


def words(name: str, title: str) -> str:
    """Return everything that a chapter says."""
    found: list[str] = []
    for block in chapter(name, title).blocks:
        if isinstance(block, Paragraph | Heading):
            found += ["".join(block.parts)]
        elif isinstance(block, Bullets):
            found += ["".join(item.parts) for item in block.items]
        elif isinstance(block, TableBlock):
            found += [" | ".join(row) for row in (block.head, *block.rows)]
    return "\n".join(found).replace("\u00a0", " ")


class Tags(HTMLParser):
    """Checks that every element of a page is closed in its turn, and collects what could run or load."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.suspicious: list[str] = []
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in ("script", "iframe", "img", "link", "object"):
            self.suspicious.append(tag)
        self.suspicious += [name for name, text in attrs if name.startswith("on") or "javascript:" in (text or "")]
        if tag not in ("meta", "wbr"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.suspicious += [name for name, _ in attrs if name.startswith("on")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def check_files(name: str, files: dict[str, str]) -> None:
    pictures = [f"{name}_{view}.svg" for view in ("front", "right", "top", "iso")]
    assert list(files) == [f"{name}.md", f"{name}.html", *pictures]
    assert Tags(files[f"{name}.html"]).suspicious == []
    for picture in pictures:
        assert ET.fromstring(files[picture]).tag == "{http://www.w3.org/2000/svg}svg"
        assert f"]({picture})" in files[f"{name}.md"]
    assert files[f"{name}.html"].count("<svg ") == 4
    names = re.findall(r' id="([^"]*)"', files[f"{name}.html"])
    assert len(set(names)) == len(names)
    assert set(re.findall(r"url\(#([^)]*)\)", files[f"{name}.html"])) <= set(names)


@pytest.mark.parametrize("name", FEW)
def test_a_report_has_all_chapters_and_files(name: str) -> None:
    assert [one.title for one in report(name).chapters] == CHAPTERS
    made = report(name)
    files = {f"{name}.md": markdown_text(made), f"{name}.html": page_text(made)}
    check_files(name, files | {made.file_of_drawing(one): one.svg for one in made.drawings})


@pytest.mark.slow
@pytest.mark.parametrize("name", chainbuild.shipped())
def test_every_shipped_machine_has_a_report(name: str) -> None:
    machine = chainbuild.load(name)
    robot = Robot(machine.chain())
    files = report_files(robot, machine)
    check_files(name, files)
    assert "No safe pose was found" not in files[f"{name}.md"]
    assert report_files(Robot.load(name), machine) == files


def test_the_same_machine_gives_the_same_files_wherever_it_lies(tmp_path: Path) -> None:
    source = shipped_path("lever_kin85")
    assert source is not None
    for suffix in (".lis", ".chainbuild.toml"):
        shutil.copy(source.with_name(f"lever_kin85{suffix}"), tmp_path)
    there = chainbuild.load(tmp_path / "lever_kin85.lis")
    here = chainbuild.load("lever_kin85")
    files = report_files(Robot(there.chain()), there)
    assert files == report_files(Robot(here.chain()), here)
    assert str(tmp_path) not in "".join(files.values())


def test_files_are_written_beside_each_other(tmp_path: Path) -> None:
    machine = chainbuild.load("lever_kin85")
    robot = Robot(machine.chain())
    page = chainbuild.write_report(robot, tmp_path, machine=machine)
    assert page == tmp_path / "lever_kin85" / "lever_kin85.html"
    assert {path.name: path.read_text("utf-8") for path in page.parent.iterdir()} == report_files(robot, machine)


def test_nothing_is_written_before_everything_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(report: Report) -> str:
        raise ChainbuildError("no page")

    monkeypatch.setattr(module, "page_text", broken)
    with pytest.raises(ChainbuildError, match="no page"):
        chainbuild.write_report(Robot.load("lever_kin85"), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_robot_alone_will_do() -> None:
    files = report_files(Robot.load("lever_kin85"))
    assert "made from the model alone" in files["lever_kin85.md"]
    assert "lever_kin85.lis" not in files["lever_kin85.md"]


def test_what_is_no_robot_of_the_machine_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ChainbuildError, match="expected a robot"):
        report_files("kr6r900")  # type: ignore[arg-type]
    machine = chainbuild.load("scara_kin36")
    with pytest.raises(ChainbuildError, match=r"not the kinematic of scara_kin36\.lis"):
        report_files(Robot.load("tx2_60"), machine)
    longer = Robot(machine.chain(tool_length_mm=50.0))
    with pytest.raises(ChainbuildError, match="not the kinematic"):
        report_files(longer, machine)
    added = machine_report(longer, machine, Selection(tool_length_mm=50.0))
    assert ["Added tool length", "50 mm"] in next(b for b in added.chapters[0].blocks if isinstance(b, TableBlock)).rows
    with pytest.raises(FileAccessError):
        chainbuild.write_report(Robot.load("lever_kin85"), 7)  # type: ignore[arg-type]


NASTY = '</title><script>x</script> | `a` *b* [c](javascript:d) ![e](f) <img src=x onerror="y">\n# g \u202e\x1b[31m'


def test_a_hostile_title_is_text() -> None:
    machine = chainbuild.load("lever_kin85")
    chain = replace(machine.chain(), title=NASTY)
    files = report_files(Robot(chain), machine)
    assert Tags(files["lever_kin85.html"]).suspicious == []
    assert "&lt;script&gt;x&lt;/script&gt;" in files["lever_kin85.html"]
    text = files["lever_kin85.md"]
    assert not re.search(r"<(script|img|/title)|[^\\]\]\(javascript|\x1b|\u202e", text)
    assert text.startswith("# &lt;/title&gt;&lt;script&gt;x&lt;/script&gt; \\| \\`a\\` \\*b\\* ")
    rows = [line for line in text.splitlines() if line.startswith("| Machine |")]
    assert len(re.findall(r"(?<!\\)\|", rows[0])) == 3


def test_cells_of_rows_stand_below_their_titles() -> None:
    text = page_text(Report("t", "n", chapters=(chapter("kr6r900", "Denavit-Hartenberg parameters"),)))
    assert text.count('<table class="rows">') == 2
    assert ".rows td:not(:first-child), .rows th:not(:first-child) { text-align: right;" in text


def test_verbatim_texts_are_code() -> None:
    blocks = [Paragraph.of("a ", Verbatim("b_c`|<d>")), TableBlock(("x", ""), [[Verbatim("e|f"), "1"]])]
    made = Report("t", "n", (Chapter("c", blocks),))
    assert "a `b_c'\\|<d>`" in markdown_text(made)
    assert "| `e\\|f` | 1 |" in markdown_text(made)
    assert "<code>b_<wbr>c`|&lt;d&gt;</code>" in page_text(made)


def test_each_datum_tells_what_it_moves() -> None:
    said = words("kr6r900", "What the file says")
    assert "$MC_ROBX_TX3P3_POS[2] | MD62908 | 35 | mm" in said
    assert "A4_link, A5_link and A6_link; tool Z +1 mm | 27" in said
    assert re.search(r"AXES_DIR\[2\] .* nothing at home; elsewhere A3_link, A4_link, A5_link and A6_link \| 51", said)
    assert "tool_length_mm | --tool-length | 0 | mm | Added to the length of the active tool. | tool X +1 mm" in said
    assert "$MC_ROBX_AXES_TYPE[0…5]" in said.partition("Data that choose what is built")[2]
    assert "$MC_ROBX_MAMES[0…5]" in said.partition("default values in force")[2]


def test_data_of_coupled_kinematics_have_their_meanings() -> None:
    machine = chainbuild.load("gantry_robot_kin210")
    blocks = data_chapter(Robot(machine.chain()), DataSource(machine, Selection(), {})).blocks
    moving = blocks[2]
    assert isinstance(moving, TableBlock)
    meaning = {row[1]: row[4] for row in moving.rows if row[1].startswith("HD")}
    known = {f"HD{row.n}": row.meaning for row in chainbuild.catalogue()[45].data.hd}
    assert meaning
    assert all(known[name] == text for name, text in meaning.items())


def test_data_of_the_file_without_effect_are_named() -> None:
    """The file of a SCARA gives length B, which its arrangement of axes does not ask for."""
    machine = chainbuild.load("scara_sc")
    blocks = data_chapter(Robot(machine.chain()), DataSource(machine, Selection(), {})).blocks
    heading = next(n for n, b in enumerate(blocks) if b == Heading(("Data of the file without effect",)))
    table = blocks[heading + 2]
    assert isinstance(table, TableBlock)
    assert [row[0] for row in table.rows] == ["$MC_ROBX_MAIN_LENGTH_AB[1]"]


def test_reach_is_that_of_the_stretched_arm() -> None:
    """25 mm beside axis 1, 455 mm of upper arm, a forearm of 420 mm with 35 mm across, 80 mm to the flange."""
    wrist = 25.0 + 455.0 + np.hypot(420.0, 35.0)
    said = words("kr6r900", "Reach")
    assert re.search(rf"wrist point from axis A1 \| 0 \|.* \| {wrist:.0f} \| A2 0°, A3 5°", said)
    assert "Axes that are not named may stand anywhere." in said
    assert re.search(rf"TCP from axis A1 \| 0 \|.* \| {wrist + 80.0:.0f} \|", said)
    assert "TCP along Z of the workpiece frame | 50 | Z 150 mm | 250 | Z 350 mm" in words("scara_kin36", "Reach")


def test_reach_heeds_limits_on_sums() -> None:
    """A2 = 75 and A3 = -105 is the far corner of the shoulder's limit and of that on their sum, -30."""
    table = next(b for b in reach_chapter(Robot.load("parallelogram_nr")).blocks if isinstance(b, TableBlock))
    wrist = next(row for row in table.rows if row[0].startswith("wrist"))
    # At 0 the arm stands up, the forearm 250 mm behind it; the motor of A3 turns the forearm against the frame.
    elbow = 400.0 + 1100.0 * np.sin(np.radians(75.0))
    assert wrist[3] == f"{elbow + 1250.0 * np.sin(np.radians(105.0)) - 250.0 * np.cos(np.radians(105.0)):.0f}"


def test_singular_positions_lie_where_they_are_said_to() -> None:
    said = words("kr6r900", "Singular positions")
    assert f"Where: A3 = {np.degrees(np.arctan2(35.0, 420.0)):.2f}°." in said
    assert "Where: A5 = 0°." in said
    at = re.search(r"for instance A2 (\S+)°, A3 (\S+)°", said)
    assert at is not None
    place = [0.0, float(at[1]), float(at[2]), 20.0, 30.0, 0.0]
    assert "shoulder" in {one.kind for one in chainbuild.examine(Robot.load("kr6r900"), place).names}
    assert "Where: A = 0°." in words("ac_table_kin58", "Singular positions")
    assert "Outside the limits" in words("scara_kin36", "Singular positions")
    assert "At B = 90° and B = -90° the angles A and C" in said


@pytest.mark.parametrize(("name", "axis"), [("oblique_head_kin11", "B"), ("kr6r900", "A5"), ("ac_table_kin58", "A")])
def test_all_values_of_a_singular_axis_are_told(name: str, axis: str) -> None:
    """Between its limits the smallest singular value comes down to 0 at these values and no others."""
    robot = Robot.load(name)
    n = [one.name for one in robot.axes].index(axis)
    reference = np.array([10.0, 10.0, -100.0, 20.0, 30.0, 40.0])[: len(robot.axes)]
    said = [block.parts[0] for block in singular_chapter(robot, reference).blocks if isinstance(block, Paragraph)]
    told = next(re.search(rf"^Where: {axis} = (.*)\.$", text) for text in said if text.startswith(f"Where: {axis} ="))
    assert told is not None
    lower, upper = robot.axes[n].lower, robot.axes[n].upper
    rows = np.tile(reference, (int(2 * (upper - lower)) + 1, 1))
    rows[:, n] = np.arange(lower, upper + 0.25, 0.5)
    smallest = chainbuild.measure_batch(robot, rows).smallest
    wanted = rows[smallest < 1e-9, n].tolist()
    assert [float(value.rstrip("°")) for value in told[1].split(" or ")] == wanted
    assert wanted


def test_a_singular_value_counts_from_the_zero_of_its_axis() -> None:
    chain = chainbuild.load("kr6r900").chain()
    assert isinstance(chain.axis_map, AffineMap)
    b = np.array([0.0, 0.0, 0.0, 0.0, np.radians(10.0), 0.0])
    robot = Robot(replace(chain, axis_map=replace(chain.axis_map, b=b)))
    blocks = singular_chapter(robot, np.array([10.0, -80.0, 70.0, 20.0, 30.0, 40.0])).blocks
    assert "Where: A5 = -10°." in [block.parts[0] for block in blocks if isinstance(block, Paragraph)]


def test_what_other_axes_make_up_for_is_not_singular() -> None:
    """A robot on two slides loses nothing by a stretched arm."""
    robot = Robot.load("robot_tilting_table_kin210")
    axes = np.array([-200.0, 50.0, 10.0, -40.0, 60.0, 20.0, 30.0, 10.0, 20.0, 10.0])
    said = [block.parts[0] for block in singular_chapter(robot, axes).blocks if isinstance(block, Paragraph)]
    assert "Where: B2 = 3.41°." in said
    assert sum("Not singular all the same" in text for text in said) == 3


def test_partials_of_a_coupling_are_said_to_have_their_own() -> None:
    blocks = singular_chapter(Robot.load("robot_tilting_table_kin210"), np.full(10, 10.0)).blocks
    said = ["".join(block.parts) for block in blocks if isinstance(block, Paragraph)]
    assert any("has its own singular positions" in text and "--kinematic NAME" in text for text in said)
    assert "own singular positions" not in words("kr6r900", "Singular positions")


def test_sums_in_a_condition_are_told_as_sums() -> None:
    chain = chainbuild.load("parallelogram_nr").chain()
    axes = tuple(replace(axis, lower=-190.0, upper=190.0) for axis in chain.axes)
    robot = Robot(replace(chain, axes=axes, constraints=()))
    blocks = singular_chapter(robot, np.array([0.0, 10.0, -60.0, 20.0, 40.0, 0.0])).blocks
    said = [block.parts[0] for block in blocks if isinstance(block, Paragraph)]
    found = next(re.search(r"Where: -A2 - A3 = (\S+)° or (\S+)°", text) for text in said if "-A2 - A3" in text)
    assert found is not None
    assert float(found[2]) == pytest.approx(np.degrees(np.arctan2(250.0, 1250.0)), abs=0.01)
    assert float(found[1]) == pytest.approx(np.degrees(np.arctan2(250.0, 1250.0)) - 180.0, abs=0.01)


def test_a_place_on_a_surface_is_singular_in_that_way_alone() -> None:
    """The upright arm of a TX2-60 is stretched as well; what is lost there is not what the shoulder loses."""
    robot = Robot.load("tx2_60")
    blocks = list(singular_chapter(robot, np.array([5.0, -60.0, 40.0, -5.0, -30.0, -115.0])).blocks)
    said = next(b.parts[0] for b in blocks if isinstance(b, Paragraph) and "surface" in b.parts[0])
    at = re.search(r"for instance B1\s(\S+)°, B2\s(\S+)°\.", said)
    assert at is not None
    found = chainbuild.examine(robot, [5.0, float(at[1]), float(at[2]), -5.0, -30.0, -115.0]).names
    assert {one.kind for one in found} == {"shoulder"}


def test_a_lost_direction_is_told_with_its_position() -> None:
    robot = Robot.load("kr6r900")
    reference = np.array([5.0, -60.0, 40.0, -5.0, -30.0, -115.0])
    items = [item for b in singular_chapter(robot, reference).blocks if isinstance(b, Bullets) for item in b.items]
    stretched = next(item.parts[0] for item in items if "stretched" in item.parts[0]).replace("\u00a0", " ")
    assert stretched.endswith("(Seen at A1 5°, A2 -60°, A3 4.76°, A4 -5°, A5 -30°, A6 -115°.)")


def test_whole_turns_of_a_singular_axis_are_told_once() -> None:
    chain = chainbuild.load("kr6r900").chain()
    renamed = {"A4": "hand_turn", "A5": "hand"}
    axes = tuple(
        replace(
            axis,
            name=renamed.get(axis.name, axis.name),
            **({"lower": -400.0, "upper": 400.0} if axis.name == "A5" else {}),
        )
        for axis in chain.axes
    )
    joints = tuple(replace(joint, name=renamed.get(joint.name, joint.name)) for joint in chain.joints)
    robot = Robot(replace(chain, axes=axes, joints=joints))
    blocks = list(singular_chapter(robot, np.array([5.0, -60.0, 40.0, -5.0, -30.0, -115.0])).blocks)
    where = next(n for n, b in enumerate(blocks) if isinstance(b, Paragraph) and b.parts[0].startswith("Where: hand ="))
    assert blocks[where] == Paragraph.of("Where: hand = -360° or -180° or 0° or 180° or 360°.")
    told = blocks[where + 1]
    assert isinstance(told, Bullets)
    # A name is written as it is, also at the beginning of a sentence.
    assert [item.parts[0].split(":")[0] for item in told.items] == ["hand_turn and A6 are parallel (hand = 0°)"]


def test_conventions_without_default_come_first_then_open_ones() -> None:
    used = chainbuild.load("rod_table_kin19").chain().conventions
    titles = [block.parts for block in conventions_chapter(used).blocks if isinstance(block, Heading)]
    ranks = []
    for name, rest in titles:
        convention = chainbuild.conventions()[name]
        ranks.append(0 if not convention.default else 1 if convention.mark == "?" else 2)
        assert ("there is no default" in rest) == (not convention.default)
    assert ranks == sorted(ranks)
    assert ranks[0] == 0
    text = words("ac_table_kin58", "What the manuals leave open")
    assert chainbuild.conventions()["table_rotary_sense"].verify in text


def test_findings_name_the_line_without_a_folder() -> None:
    assert "CB307 | warning | kr6r900.tea:48 |" in words("kr6r900", "Findings")
    assert words("scara_kin36", "Findings") == "None."


def test_the_machine_is_told_with_its_tool_and_angles() -> None:
    said = words("kr6r900", "Machine")
    assert "Tool | none, the TCP is in the flange" in said
    assert "angles orirpy: Rz(A)·Ry(B)·Rx(C)" in said
    assert "Bodies are assumed by rule. Machine data say nothing of castings." in words("kr6r900", "Pictures")


def test_axes_tell_where_their_limits_come_from() -> None:
    assert "A2 | rotary | deg | -190 | 45 | overlay | 300 deg/s" in words("kr6r900", "Axes, limits and drives")
    said = words("lambda_kin21", "Axes, limits and drives")
    assert "closed by 1 loop. No axis drives" in said
    table = axes_chapter(Robot.load("parallelogram_nr"), None).blocks
    assert ["parallelogram angle (alarm 75329)", "A2 + A3 + 180", "30", "150"] in table[2].rows
