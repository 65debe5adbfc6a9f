"""Pairs of transformation steps: which two kinematics are chosen, by what, and what is said where there is no pair."""

from __future__ import annotations

from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import MachineDataError, OverlayError
from chainbuild.formats.overlay import read_overlay
from tests.kit.command_line import Run
from tests.kit.twincat_files import codes, machine, pose

# Heads in step 0, tables in step 1; no defaults.
STEPS = """trafo[0].id 9
trafo[0].param[0] 1200000
trafo[1].id 45
trafo[1].name ROBOT
kin_step[1].trafo[0].id 58
kin_step[1].trafo[0].param[8] -5000000
kin_step[1].trafo[1].id 57
kin_step[1].trafo[1].name B_TABLE
kin_step[1].trafo[1].param[7] 300000
"""
AXES = [10.0, 20.0, 30.0, 40.0, 50.0]
POSSIBLE = "step 0: 9, 45 (ROBOT); step 1: 58, 57 (B_TABLE)"


def by_default(first: int, second: int) -> object:
    """Return the pose of a pair that the list names itself."""
    text = f"{STEPS}default_id_of_kin_step[0] {first}\ndefault_id_of_kin_step[1] {second}\n"
    return pose(machine(text).chain(), AXES)


@pytest.mark.parametrize("pair", [(9, 58), ("9", "58"), [9, 58], (9, "58")])
def test_a_pair_is_chosen(pair: tuple[int | str, int | str]) -> None:
    chain = machine(STEPS).chain(kinematic=pair)
    assert chain.kinematic == "KIN_TYP 9 below KIN_TYP 58"
    assert "CB412" not in codes(chain)
    assert pose(chain, AXES) == pytest.approx(by_default(9, 58), abs=1e-12)


def test_another_pair_than_the_default() -> None:
    text = f"{STEPS}default_id_of_kin_step[0] 9\ndefault_id_of_kin_step[1] 58\n"
    other = machine(text).chain(kinematic=(9, "B_TABLE"))
    assert other.kinematic == "KIN_TYP 9 below KIN_TYP 57"
    assert pose(other, AXES) == pytest.approx(by_default(9, 57), abs=1e-12)
    assert abs(pose(other, AXES) - pose(machine(text).chain(), AXES)).max() > 10
    assert other.name == "machine_kin9_B_TABLE_two_steps"
    assert machine(text).chain(kinematic=(9, 58)).name == "machine"


@pytest.mark.parametrize(
    ("pair", "text", "hint"),
    [
        ((58, 9), "step 0 has no kinematic 58 and step 1 has no kinematic 9", "step 0 is next to the machine"),
        ((9, 77), "step 1 has no kinematic 77", None),
        (("ROBOTER", 58), "step 0 has no kinematic 'ROBOTER'", None),
    ],
)
def test_a_wrong_pair_lists_what_is_possible(pair: tuple[int | str, int | str], text: str, hint: str | None) -> None:
    with pytest.raises(MachineDataError) as caught:
        machine(STEPS).chain(kinematic=pair)
    error = caught.value
    assert text in error.message
    assert (error.permitted, error.alarm, error.code) == (POSSIBLE, 21630, "CB404")
    assert error.hint is None if hint is None else hint in (error.hint or "")


def test_a_pair_needs_two_steps() -> None:
    with pytest.raises(MachineDataError, match="needs two transformation steps") as caught:
        machine("trafo[0].id 9\ntrafo[1].id 58").chain(kinematic=(9, 58))
    assert caught.value.permitted == "one of 9, 58"
    with pytest.raises(MachineDataError, match="needs two transformation steps"):
        chainbuild.load("kr6r900").chain(kinematic=(1, 2))


@pytest.mark.parametrize("pair", [(9,), (9, 58, 1), (9, None), (True, 58), (9, ""), ()])
def test_what_is_no_pair(pair: object) -> None:
    with pytest.raises(MachineDataError) as caught:
        machine(STEPS).chain(kinematic=pair)  # type: ignore[arg-type]
    assert caught.value.permitted == "an id, a name, a pair of these for the two steps, or None"


def test_a_pair_in_another_channel() -> None:
    lists = ("trafo[0].id 2\n", STEPS)
    body = "".join(f"<Channel><SdaMds><![CDATA[{text}]]></SdaMds></Channel>" for text in lists)
    found = machine(f"<TcSmProject>{body}</TcSmProject>")
    with pytest.raises(MachineDataError) as caught:
        found.chain(kinematic=(9, 58))
    assert caught.value.message == "channel 0 configures no kinematic (9, 58)"
    assert caught.value.hint == "it is in channel 1: choose that channel"
    assert found.chain(kinematic=(9, 58), channel=1).kinematic == "KIN_TYP 9 below KIN_TYP 58"


def test_an_id_that_stands_twice_in_its_step() -> None:
    chain = machine(f"{STEPS}kin_step[1].trafo[2].id 58\nkin_step[1].trafo[2].name OTHER\n").chain(kinematic=(9, 58))
    told = [finding.text for finding in chain.findings if finding.code == "CB411"]
    assert told == ["the id 58 is that of 2 kinematics: one without a name, 'OTHER'; the one without a name is taken"]


@pytest.mark.parametrize(
    ("defaults", "text", "hint"),
    [
        (
            "default_id_of_kin_step[0] 9",
            "transformation step 1 has no default kinematic: the controller refuses #TRAFO until #KIN ID chooses both;"
            " only 9 of step 0 is built",
            "choose a pair: --kinematic 9,58, kinematic=(9, 58)",
        ),
        (
            "default_id_of_kin_step[1] 57",
            "transformation step 0 has no default kinematic: the controller refuses #TRAFO until #KIN ID chooses both;"
            " 9 is taken",
            "choose a pair: --kinematic 9,57, kinematic=(9, 57)",
        ),
        (
            "",
            "neither transformation step has a default kinematic: the controller refuses #TRAFO until #KIN ID chooses"
            " both; only 9 of step 0 is built",
            "choose a pair: --kinematic 9,58, kinematic=(9, 58)",
        ),
    ],
)
def test_a_missing_default(defaults: str, text: str, hint: str) -> None:
    told = [f for f in machine(f"{STEPS}{defaults}").chain().findings if f.code == "CB412"]
    assert [(f.severity, f.text, f.hint) for f in told] == [("warning", text, hint)]
    both = "default_id_of_kin_step[0] 9\ndefault_id_of_kin_step[1] 57"
    assert "CB412" not in codes(machine(f"{STEPS}{both}").chain())


def test_the_steps_of_the_entries_and_their_parameters() -> None:
    found = machine(STEPS)
    assert [(entry.id, entry.step) for entry in found.kinematics()] == [(9, 0), (45, 0), (58, 1), (57, 1)]
    rows = found.parameters((9, 58))
    assert [row.name for row in rows if row.given] == ["trafo[0].param[0]", "kin_step[1].trafo[0].param[8]"]
    assert [row.symbol for row in rows].count("P-CHAN-00112") == 1


def test_the_overlay_names_a_pair(tmp_path: Path) -> None:
    overlay = tmp_path / "m.chainbuild.toml"
    overlay.write_text('kinematic = [9, "B_TABLE"]\n[limits]\nX = [-100, 100]\n', "utf-8")
    found = machine(STEPS, overlay=read_overlay(overlay))
    chain = found.chain()
    assert chain.kinematic == "KIN_TYP 9 below KIN_TYP 57"
    assert (chain.axes[0].lower, chain.axes[0].upper) == (-100, 100)
    for wrong in ("[9]", "[9, true]", "[9, 58, 57]", "[9, '']"):
        overlay.write_text(f"kinematic = {wrong}\n", "utf-8")
        with pytest.raises(OverlayError, match="kinematic"):
            read_overlay(overlay)


def test_by_the_command_line(run: Run) -> None:
    Path("two.lis").write_text(STEPS, "utf-8")
    chosen = run("fk", "two.lis", "--kinematic", "9,58", "--at", "10,20,30,40,50")
    named = run("fk", "two.lis", "--kinematic", "9, B_TABLE", "--at", "10,20,30,40,50")
    assert (chosen.code, named.code) == (0, 0)
    values = [float(text) for text in chosen.out.splitlines()[1].split(",")[:3]]
    assert values == pytest.approx(by_default(9, 58)[:3, 3], abs=1e-9)  # type: ignore[index]
    assert chosen.out != named.out
    for text in ("9,", ",58", "9,58,57"):
        outcome = run("fk", "two.lis", "--kinematic", text, "--at", "0,0,0,0,0")
        assert outcome.code == 2
        assert "expected an id, a name, or a pair of them like 9,58" in outcome.err
    assert POSSIBLE in run("fk", "two.lis", "--kinematic", "58,9", "--at", "0,0,0,0,0").err
    shown = run("info", "two.lis", "--kinematic", "9,58")
    assert "KIN_TYP 58, step 1" in shown.out
    assert "KIN_TYP 9 below KIN_TYP 58" in shown.out


def test_a_name_with_a_comma_is_one_name(run: Run) -> None:
    Path("m.lis").write_text('trafo[0].id 9\ntrafo[1].id 58\ntrafo[1].name "A,B"\n', "utf-8")
    assert run("fk", "m.lis", "--kinematic", "A,B", "--at", "0,0,0,90,0").code == 0


def test_a_robot_of_a_pair(tmp_path: Path) -> None:
    file = tmp_path / "two.lis"
    file.write_text(STEPS, "utf-8")
    robot = chainbuild.Robot.load(file, kinematic=(9, 58))
    assert robot.fk(AXES).homogeneous[:3, 3] * 1000 == pytest.approx(by_default(9, 58)[:3, 3], abs=1e-9)  # type: ignore[index]
    selection = chainbuild.Selection((9, 58))
    check = chainbuild.crosscheck(robot, robot.fk, machine=chainbuild.load(file), selection=selection)
    assert check.agrees
