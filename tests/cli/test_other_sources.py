"""Every command that takes a machine file takes a URDF and a table of Denavit-Hartenberg parameters."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import chainbuild
from tests.kit.command_line import Run, rows_of, write
from tests.kit.paths import TESTS

URDF = TESTS / "bench" / "kr6r700.urdf"
DH = """# standard
a;d;alpha;theta;kind;lower;upper
25;400;-90;0;R;-170;170
315,5;0;0;-90;R;-100;100
35;0;-90;0;R;-110;110
0;365;90;0;R;-180;180
0;0;-90;0;R;-115;115
0;80;0;180;R;-350;350
"""
AT = "10,-20,30,40,50,60"


@pytest.fixture(params=["URDF", "Denavit-Hartenberg"])
def machine(request: pytest.FixtureRequest, run: Run) -> str:
    if request.param == "URDF":
        return str(URDF)
    write("arm.csv", DH)
    return "arm.csv"


def names_of(machine: str) -> list[str]:
    return [axis.name for axis in chainbuild.load(machine).chain().axes]


def test_info_and_check(run: Run, machine: str) -> None:
    shown = run("info", machine)
    told = json.loads(run("info", machine, "--json").out)
    dialect = "URDF" if machine.endswith("urdf") else "Denavit-Hartenberg"
    assert (shown.code, told["dialect"], told["refused"]) == (0, dialect, False)
    assert {axis["limits_from"] for axis in told["axes"]} == {"file"}
    named = "kr6r700sixx, from base_link to tool0" if dialect == "URDF" else "T = Rz(theta) Tz(d) Tx(a) Rx(alpha)"
    assert named in shown.out
    assert run("check", machine).code == 0


def test_fk_and_ik_find_the_way_back(run: Run, machine: str) -> None:
    names = names_of(machine)
    write("axes.csv", f"{','.join(names)}\n{AT}\n")
    assert run("fk", machine, "--axes", "axes.csv", "-o", "poses.csv").code == 0
    found = run("ik", machine, "--poses", "poses.csv", "--start", "axes.csv")
    (row,) = rows_of(found.out)
    assert [float(row[name]) for name in names] == pytest.approx([float(word) for word in AT.split(",")], abs=1e-6)


def test_written_files_are_the_same_machine(run: Run, machine: str) -> None:
    path = run("urdf", machine, "-o", "out").out.split()[0]
    (expected,), (found,) = (
        rows_of(run("fk", *words, "--at", AT).out) for words in ((machine,), (path, "--tool", "tool"))
    )
    columns = ("x_mm", "y_mm", "z_mm", "qx", "qy", "qz", "qw")
    assert [float(found[name]) for name in columns] == pytest.approx([float(expected[name]) for name in columns])


COMMANDS = {
    "export": (("export", "--format", "urdf,mjcf,srdf,opw", "-o", "out", "--samples", "50"), 0),
    "singularity": (("singularity", "--at", AT), 0),
    "collide": (("collide", "--at", "0,0,0,0,30,0", "--json"), None),
    "limits": (("limits", "--axis", "#3", "--over", "#2", "--steps", "2"), 0),
    "picture": (("picture", "-o", "arm.svg", "--dimensions"), 0),
    "inspect": (("inspect", "--export", "page.html"), 0),
    "crosscheck": (("crosscheck", "--solver", "opw", "--count", "6"), 0),
}


@pytest.mark.parametrize(("words", "code"), COMMANDS.values(), ids=COMMANDS)
def test_other_commands(run: Run, machine: str, words: tuple[str, ...], code: int | None) -> None:
    axes = names_of(machine)
    name, *options = [axes[int(word[1:]) - 1] if word.startswith("#") else word for word in words]
    found = run(name, machine, *options)
    assert found.code == code or (code is None and found.code in (0, 3))
    assert found.out
    written = {"picture": "arm.svg", "inspect": "page.html"}
    if name in written:
        assert Path(written[name]).stat().st_size > 1000


def test_the_live_page_has_the_machine(machine: str) -> None:
    from chainbuild.comparison.convention_trials import Selection
    from chainbuild.inspect.live.session import Session

    page = Session(chainbuild.load(machine), Selection(None, None, 0.0)).page("")
    assert ("joint_a3" if machine.endswith("urdf") else "theta6") in page


def test_values_go_by_data_and_not_by_names(run: Run, machine: str) -> None:
    read = chainbuild.load(machine)
    datum = next(one for one in read.geometry() if one.unit == "mm" and one.value)
    moved = read.with_values({datum: datum.value + 10}).geometry()
    assert [one.value for one in moved if one.name == datum.name] == [datum.value + 10]
    for values, said in (
        ({datum.name: 1.0}, f"'{datum.name}' is no datum; a name may belong to several"),
        (
            {datum: "long"},
            f"the value of {datum.name} is no number: 'long'; parameter values; permitted: a number in mm",
        ),
        ([datum], "expected a dict of data of geometry() and tool_data(), got list"),
    ):
        with pytest.raises(chainbuild.ChainbuildError) as caught:
            read.with_values(values)  # type: ignore[arg-type]
        assert said in str(caught.value)


def test_what_cannot_be_done_is_one_sentence(run: Run, machine: str) -> None:
    for words in (("as-universal", machine), ("types", machine)):
        found = run(*words)
        assert found.code in (1, 2)
        assert found.out == ""
        assert found.err.count("\n") <= 2
    assert "cannot be written as KIN_TYP 91" in run("as-universal", machine).err


def test_a_wrong_datum_of_a_dh_table_is_named(run: Run) -> None:
    write("arm.csv", DH)
    write("axes.csv", "A1,A2,A3,A4,A5,A6\n10,20,30,40,50,60\n-40,-30,20,10,-50,5\n0,15,-35,70,60,-90\n5,5,5,5,5,5\n")
    poses = run("fk", "arm.csv", "--axes", "axes.csv").out
    lines = zip(Path("axes.csv").read_text("utf-8").splitlines(), poses.splitlines(), strict=True)
    write("recorded.csv", "".join(f"{left},{right}\n" for left, right in lines))
    write("arm.csv", DH.replace("315,5", "317,5"))
    found = run("crosscheck", "arm.csv", "--recording", "recorded.csv")
    assert found.code == 3
    assert "a2" in found.out
    assert "315.5" in found.out


def test_the_tool_link_is_an_option_of_a_urdf(run: Run) -> None:
    at = run("fk", URDF, "--tool", "link_3", "--at", "0,0,0")
    assert at.code == 0
    wrong = run("fk", URDF, "--tool", "link_9", "--at", "0,0,0")
    assert (wrong.code, wrong.out) == (1, "")
    assert "no joint leads to a link 'link_9'" in wrong.err
    other = run("fk", "kr6r900", "--tool", "link_3", "--at", AT)
    assert (other.code, other.out) == (1, "")
    assert "is no URDF" in other.err
    assert "permitted: no tool link; a tool length is added by --tool-length" in other.err
    both = run("fk", URDF, "--tool", "link_3", "--kinematic", "link_2", "--at", "0,0,0")
    assert (both.code, both.out) == (2, "")
    assert "--kinematic link_2 and --tool link_3: both name the tool link" in both.err
    assert run("fk", URDF, "--tool", "link_3", "--kinematic", "link_3", "--at", "0,0,0").out == at.out


def test_hints_name_the_tool_link(run: Run) -> None:
    text = URDF.read_text("utf-8").replace("</robot>", "") + (
        '<link name="eye"/><joint name="eye" type="fixed"><parent link="link_6"/><child link="eye"/></joint></robot>'
    )
    write("two.urdf", text)
    refused = run("fk", "two.urdf", "--at", AT)
    assert refused.code == 1
    assert "2 links could be the tool; permitted: eye, tool0; name the link whose frame is the TCP" in refused.err
    assert "--tool tool0" in refused.err
    assert run("fk", "two.urdf", "--tool", "tool0", "--at", AT).out == run("fk", URDF, "--at", AT).out
    listed = run("info", "two.urdf", "--tool", "tool0").out
    assert "--tool eye" in listed
