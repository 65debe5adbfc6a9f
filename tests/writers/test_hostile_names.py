"""Names with markup, escapes, line ends and paths, through every output: nothing runs, nothing leaves its folder."""

from __future__ import annotations

import json
import re
import shutil
import unicodedata
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import pytest

import chainbuild
from chainbuild.cli import main
from chainbuild.errors import FileAccessError
from chainbuild.machines import shipped_path
from chainbuild.writers.models.srdf import write_srdf
from tests.kit.browser import document

RUN = "document.body.dataset.ran='no'+6*7"  # what would run leaves no42 in the document
NASTY = (
    f"\x1b]0;t\x07\x1b[31m</title></pre><script>{RUN}</script><img src=x onerror=\"{RUN}\">' onload='{RUN}' "
    f"${{title}} \u202e\x9b -->]]></style><svg onload={RUN}>\r\n../../up\u2028"
)
STEM = f"..-\x1b[2J<script>{RUN}".replace("/", "")
AT = "0,-90,90,0,0,0"


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return the name of a machine file whose name, title and axis list are hostile, in an empty folder."""
    source = shipped_path("kr6r900")
    assert source is not None
    folder = tmp_path / "in"
    folder.mkdir()
    shutil.copy(source, folder / f"{STEM}.tea")
    overlay = source.with_name("kr6r900.chainbuild.toml").read_text("utf-8")
    kept = re.sub(r"^name *=.*$", "", overlay, flags=re.MULTILINE)
    (folder / f"{STEM}.chainbuild.toml").write_text(f"name = {json.dumps(NASTY)}\n{kept}", "utf-8")
    monkeypatch.chdir(folder)
    return f"{STEM}.tea"


def commands_a_terminal(text: str) -> bool:
    return any(unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp") for c in text if c not in "\n\t")


@pytest.mark.parametrize(
    "words",
    [
        "info", "check", "info --json", "types", "check --json", "urdf", "demo", f"fk --at {AT}", f"collide --at {AT}",
        f"singularity --at {AT}", "workspace --samples 50 --cells 4 --workers 1", "couple --tcp X=1",
        "info --kinematic \x1b[31m9", "crosscheck --solver no\x1b[31m:f", "as-universal", f"ik --poses {STEM}.csv",
    ],
)  # fmt: skip
def test_no_text_of_a_file_commands_the_terminal(words: str, machine: str, capsys: pytest.CaptureFixture[str]) -> None:
    command, *options = words.split(" ")
    main([command, *([] if command == "types" else [machine]), *options])
    captured = capsys.readouterr()
    assert captured.out + captured.err
    assert not commands_a_terminal(captured.out), captured.out
    assert not commands_a_terminal(captured.err), captured.err


FORGED = "name\nFORGED: all is well"


@pytest.mark.parametrize(
    "words",
    [
        "info", "check", f"fk --at {AT}", f"collide --at {AT}", "crosscheck --solver opw --count 9", "limits", "demo",
        "workspace --samples 50 --cells 4 --workers 1", "couple --tcp X=1", f"singularity --at {AT}", "urdf",
        "crosscheck --recording FORGED", "ik --poses FORGED", "ik --poses absent-FORGED",
        "limits --axis A3 --over FORGED", "info --convention FORGED=x", "info --kinematic FORGED",
        "info --channel FORGED", f"fk --at {AT} --angles FORGED",
        "couple --lock FORGED", "singularity --at FORGED", "info --FORGED", "info FORGED", "crosscheck --solver FORGED",
    ],
)  # fmt: skip
def test_a_name_does_not_begin_a_line(
    words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Else a machine could say of itself what the command has not found."""
    monkeypatch.chdir(tmp_path)
    source = shipped_path("kr6r900")
    assert source is not None
    doubtful = source.read_text("utf-8") + "$MC_ROBX_NO_SUCH_DATUM=1\n"  # a finding that every command tells, by file
    Path(f"{FORGED}.tea").write_text(doubtful, "utf-8")
    Path(f"{FORGED}.chainbuild.toml").write_text(f"name = {json.dumps(FORGED)}\n", "utf-8")
    poses, recorded = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg", f"A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm\n{AT},5140,0,850\n"
    Path(FORGED).write_text(recorded if "crosscheck" in words else f"{poses}\n5140,0,850,0,0,0\n", "utf-8")
    command, *options = words.split(" ")
    main([command, f"{FORGED}.tea", *(option.replace("FORGED", FORGED) for option in options)])
    captured = capsys.readouterr()
    lines = (captured.out + captured.err).splitlines()
    assert "FORGED: all is well" in captured.out + captured.err or command == "urdf"
    assert not [line for line in lines if line.lstrip().startswith("FORGED")], lines


@pytest.mark.parametrize(
    "overlay",
    [
        "[limits]\nNAME = [0, 1]\n", "[speeds]\nNAME = 1\n", "endless = [NAME]\n", "[conventions]\nNAME = 'x'\n",
        "kinematic = NAME\n", "[tool]\nNAME = 1\n", "NAME = 1\n", "[geometry]\nNAME = 3\n", "axis_lists = [NAME]\n",
    ],
)  # fmt: skip
def test_a_key_of_the_overlay_does_not_begin_a_line(
    overlay: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = shipped_path("kr6r900")
    assert source is not None
    shutil.copy(source, tmp_path / "m.tea")
    (tmp_path / "m.chainbuild.toml").write_text(overlay.replace("NAME", json.dumps(FORGED)), "utf-8")
    for command in ("info", "check"):
        main([command, str(tmp_path / "m.tea")])
        captured = capsys.readouterr()
        lines = (captured.out + captured.err).splitlines()
        assert not [line for line in lines if line.lstrip().startswith("FORGED")], lines


@pytest.mark.parametrize(
    "text",
    [
        "trafo[0].id 9\ntrafo[0].name \x1b[31mq\ntrafo[0].type\x1b[31m 5\n",
        "$MC_ROBX_NUM_AXES=\x1b[31m\x9b6x\n",
        "\x1b[2J no machine data\n",
        "<a>\x1b</a>",
        "trafo[0].id 9\ntrafo[0].param[\x1b] 9\n",
    ],
)
def test_a_marked_line_is_escaped_and_marked_where_it_is_wrong(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad\x07.lis"
    path.write_text(text, "utf-8")
    for command in ("info", "check"):
        assert main([command, str(path)]) in (0, 1)
        captured = capsys.readouterr()
        assert not commands_a_terminal(captured.out + captured.err)
        assert "\\x07" in captured.out + captured.err


def test_the_mark_stands_under_the_spot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bad.tea"
    path.write_text("\t$MC_ROBX_NUM_AXES=6 \x1b[0m $MC_ROBX_BACK_FACTOR=x\n", "utf-8")
    main(["info", str(path)])
    lines = capsys.readouterr().err.splitlines()
    line, mark = lines[-2:]
    assert mark.endswith("^")
    assert mark.strip(" \t^") == ""
    assert "\\x1b" in line


def test_what_is_written_can_be_read_and_runs_nothing(machine: str, tmp_path: Path) -> None:
    Path("recorded.csv").write_text(f"A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm\n{AT},514.282,0,850\n", "utf-8")
    before = {path for path in tmp_path.rglob("*") if path.is_file()}
    for words in (
        "inspect --export out/page.html",
        "crosscheck --recording recorded.csv --html out/check.html",
        f"collide --at {AT} --picture out/distance.svg",
        "collide --pairs --samples 5 --srdf out",
        f"singularity --at {AT} --picture out/measure.svg",
        "limits --axis A3 --over A2 --steps 2 --picture out/free.svg",
        "workspace --samples 50 --cells 4 --workers 1 --picture out/map.svg -o out/map.npz",
        "urdf -o out",
    ):
        Path("out").mkdir(exist_ok=True)
        command, *options = words.split(" ")
        assert main([command, machine, *options]) in (0, 3), words
    written = {path for path in tmp_path.rglob("*") if path.is_file()} - before
    assert all(path.is_relative_to(tmp_path / "in" / "out") for path in written)
    assert {path.suffix for path in written} == {".html", ".svg", ".srdf", ".urdf", ".npz"}
    for path in written - {tmp_path / "in" / "out" / "map.npz"}:
        assert not commands_a_terminal(path.read_text("utf-8")) or path.name == "page.html", path  # the viewer's code
        if path.suffix in (".svg", ".srdf", ".urdf"):
            ET.parse(path)  # well-formed
    # One after the other in one document, which a browser reads like several.
    shown_in = sorted(
        (path for path in written if path.suffix in (".svg", ".html")), key=lambda path: path.name != "page.html"
    )
    together = tmp_path / "together.html"
    together.write_text("\n".join(path.read_text("utf-8") for path in shown_in), "utf-8")
    shown = document(together, "")
    assert shown.count("<svg") >= 4
    assert 'data-ran="' not in shown
    assert "no42" not in shown


@pytest.mark.parametrize("name", ["../up", "..", ".", "", "a/b", "a\\b", "/etc/x", "a\x00b", "a\nb"])
def test_a_name_that_is_a_path_is_refused(name: str, tmp_path: Path) -> None:
    robot = chainbuild.Robot(replace(chainbuild.load("kr6r900").chain(), name=name))
    with pytest.raises(FileAccessError, match="cannot be the name of a file"):
        chainbuild.write_urdf(robot, tmp_path / "out")
    with pytest.raises(FileAccessError, match="cannot be the name of a file"):
        write_srdf(robot, tmp_path / "out", samples=3)
    assert not list(tmp_path.rglob("*"))
