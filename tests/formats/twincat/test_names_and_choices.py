"""Names in a list that nothing reads, which kinematic an id or a default means, and what the chains are called."""

from __future__ import annotations

from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import MachineDataError
from chainbuild.findings import Finding
from tests.kit.twincat_files import codes, machine


def found(text: str, code: str) -> list[Finding]:
    return [finding for finding in machine(text).findings if finding.code == code]


# ---------------------------------------------------------------- names that nothing reads


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("trafo[0].paramm[0] 5", "did you mean trafo[0].param[k]?"),
        ("trafo[0].param[1][2] 5", "did you mean trafo[0].param[k]?"),
        ("trafo[0].parm[0] 5", "did you mean trafo[0].param[k]?"),
        ("trafo[0].foo 1", None),
        ("trafo[0].typ 58", "did you mean trafo[0].type?"),
        ("trafo[0].id[0] 58", "did you mean trafo[0].id?"),
        ("trafo[0].nam X", "did you mean trafo[0].name?"),
        ("kin_step[0].trafo[0].prams[3] 1", "did you mean kin_step[0].trafo[0].param[k]?"),
    ],
)
def test_a_misspelt_parameter_is_a_warning(line: str, hint: str | None) -> None:
    root = "kin_step[0].trafo[0]" if line.startswith("kin") else "trafo[0]"
    (finding,) = found(f"{root}.id 9\n{line}\n", "CB227")
    assert (finding.severity, finding.hint) == ("warning", hint)
    assert line.split(maxsplit=1)[0] in finding.text
    assert finding.span is not None
    assert (finding.span.file, finding.span.line) == ("machine.lis", 2)


def test_a_parameter_of_another_type_is_a_warning() -> None:
    (finding,) = found("trafo[0].id 9\ntrafo[0].zero_position[2] 5\n", "CB227")
    assert "has no effect on KIN_TYP 9" in finding.text


def test_names_that_are_read_leave_no_finding() -> None:
    text = "trafo[0].id 9\ntrafo[0].name A\ntrafo[0].type 9\ntrafo[0].param[0] 1000\ntrafo[0].base[2] 5\n"
    assert codes(machine(text + "trafo[0].lock_dof[0] 1\n")) == []


def test_kinematics_with_named_parameters_judge_them_themselves() -> None:
    text = "trafo[0].id 91\ntrafo[0].nummer 3\ntrafo[1].id 210\ntrafo[1].grup[0].chain[0] X\n"
    assert found(text, "CB227") == []


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("wz[1].lange 5", "did you mean wz[1].laenge?"),
        ("wz[1].laenge[0] 5", "did you mean wz[1].laenge?"),
        ("wz[1].kinematic.parm[0] 5", "did you mean wz[1].kinematic.param[k]?"),
        ("wz[1].kinematic.param[0][1] 5", "did you mean wz[1].kinematic.param[k]?"),
        ("wz[1].wz_kopf_versatz[0][1] 5", "did you mean wz[1].wz_kopf_versatz?"),
    ],
)
def test_a_tool_entry_that_looks_like_geometry_is_a_warning(line: str, hint: str) -> None:
    (finding,) = found(f"trafo[0].id 9\n{line}\n", "CB245")
    assert (finding.hint, finding.severity) == (hint, "warning")


def test_other_tool_entries_are_left_alone() -> None:
    text = "trafo[0].id 9\nwz[1].nr 1\nwz[1].typ 0\nwz[1].gueltig 1\nwz[1].ax_versatz[0] 5\nwz[1].laenge 1000\n"
    assert codes(machine(text)) == ["CB246"]  # the tool is not active


# ---------------------------------------------------------------- which kinematic is meant

TWICE = "trafo[0].id 9\ntrafo[0].name LONG\ntrafo[1].id 9\ntrafo[1].name SHORT\ntrafo[1].param[0] 500000\n"


def test_an_id_of_several_kinematics_leaves_a_finding() -> None:
    chain = machine(TWICE).chain(9)
    (finding,) = [f for f in chain.findings if f.code == "CB411"]
    assert "'LONG', 'SHORT'; 'LONG' is taken" in finding.text
    for quiet in (machine(TWICE).chain("SHORT"), machine(TWICE).chain()):
        assert "CB411" not in codes(quiet)


def test_a_default_by_such_an_id_leaves_one_too() -> None:
    assert "CB411" in codes(machine("kinematik_id 9\n" + TWICE).chain())
    assert "CB411" not in codes(machine("kinematik_id 9\nkinematik_name SHORT\n" + TWICE).chain())


def test_an_id_means_the_kinematic_that_no_name_could_tell() -> None:
    text = TWICE + "trafo[2].id 9\ntrafo[2].param[0] 900000\n"
    chain = machine(text).chain(9)
    assert chainbuild.Robot(chain).fk([0] * 5).translation[2] == pytest.approx(-0.09)
    assert "the one without a name is taken" in " ".join(finding.text for finding in chain.findings)


@pytest.mark.parametrize(
    ("default", "line", "says"),
    [
        ("kinematik_id 9\nkinematik_name B", 2, "id 9 and name 'B', which contradict each other"),
        ("kinematik_id 9\nkinematik_name Q", 2, "id 9 and name 'Q', but no kinematic has this name"),
        ("kinematik_id 7\nkinematik_name A", 1, "id 7 and name 'A', but no kinematic has this id"),
        ("kinematik_id 7\nkinematik_name Q", 1, "no kinematic has this id or name"),
        ("kinematik_name Q\nkinematik_id 0", 1, "default kinematic 'Q' is not configured"),
        ("kinematik_id 0\nkinematik_name Q", 2, "default kinematic 'Q' is not configured"),
        ("kinematik_name A\ndefault_id_of_kin_step[0] 58", 2, "id 58 and name 'A', which contradict"),
    ],
)
def test_a_default_that_contradicts_itself(default: str, line: int, says: str) -> None:
    text = default + "\ntrafo[0].id 9\ntrafo[0].name A\ntrafo[1].id 58\ntrafo[1].name B\n"
    if "kin_step" in default:
        text = text.replace("kinematik_name", "default_name_of_kin_step[0]")
        line = 1
    with pytest.raises(MachineDataError) as caught:
        machine(text).chain()
    assert says in caught.value.message
    assert (caught.value.line, caught.value.permitted) == (line, "9 (A), 58 (B)")
    (finding,) = found(text, "CB222")
    assert finding.span is not None
    assert (finding.text, finding.span.line) == (caught.value.message, line)


# ---------------------------------------------------------------- names of chains


def test_every_kinematic_of_a_file_has_a_name_of_its_own(tmp_path: Path) -> None:
    text = (
        "trafo[0].id 58\ntrafo[1].id 36\ntrafo[2].id 9\ntrafo[2].name Bär/9\ntrafo[3].id 9\ntrafo[3].name BäR 9\n"
        "trafo[4].id 202\ntrafo[4].name kin36\n"
    )
    found = machine(text)
    chains = [found.chain(entry.name or entry.id) for entry in found.kinematics()]
    names = [chain.name for chain in chains]
    assert names == ["machine", "machine_kin36", "machine_B_r_9", "machine_B_R_9_2", "machine_kin36_2"]
    assert found.chain().name == "machine"
    paths = {chainbuild.write_urdf(chainbuild.Robot(chain), tmp_path) for chain in chains}
    assert len({str(path).lower() for path in paths}) == 5


def test_the_default_keeps_the_plain_name() -> None:
    text = "kinematik_id 36\ntrafo[0].id 58\ntrafo[1].id 36\n"
    assert machine(text).chain().name == machine(text).chain(36).name == "machine"
    assert machine(text).chain(58).name == "machine_kin58"


def test_two_steps_and_the_first_of_them_are_told_apart() -> None:
    text = "default_id_of_kin_step[0] 9\ndefault_id_of_kin_step[1] 58\ntrafo[0].id 9\nkin_step[1].trafo[0].id 58\n"
    found = machine(text)
    assert [found.chain(k).name for k in (None, 9, 58)] == ["machine", "machine_kin9", "machine_kin58"]


def test_channels_are_told_apart() -> None:
    lists = "".join(f"<Channel><SdaMds><![CDATA[trafo[0].id {kin}\n]]></SdaMds></Channel>" for kin in (9, 9, 58))
    found = machine(f"<TcSmProject>{lists}</TcSmProject>")
    names = [found.chain(channel=channel).name for channel in (None, 0, 1, 2)]
    assert names == ["machine", "machine", "machine_channel1_kin9", "machine_channel2_kin58"]
