"""Doubts about a list: misspelt beginnings, blanks in names, fractions and units of counts, strange arms, tools."""

from __future__ import annotations

from pathlib import Path

import pytest

from chainbuild.errors import ChainbuildError, MachineDataError
from chainbuild.findings import Finding
from chainbuild.formats.load import check
from chainbuild.formats.overlay import Overlay
from tests.kit.twincat_files import codes, kin_45, machine

ARMS = {8: 4550000.0, 9: 4200000.0}


def found(text: str, code: str) -> list[Finding]:
    return [finding for finding in machine(text).chain().findings if finding.code == code]


# ---------------------------------------------------------------- names


@pytest.mark.parametrize(
    ("line", "meant"),
    [
        ("traffo[0].param[2] 5", "trafo"),
        ("Trafos[0].param[2] 5", "trafo"),
        ("kinstep[0].trafo[0].param[2] 5", "kin_step"),
        ("kinematic[9].param[2] 5", "kinematik"),
        ("kinematk_id 9", "kinematik_id"),
        ("wzz[2].laenge 5", "wz"),
    ],
)
def test_a_misspelt_beginning_is_a_warning(line: str, meant: str) -> None:
    (finding,) = found(f"trafo[0].id 9\n{line}\n{line}\n", "CB215")
    assert (finding.severity, finding.hint) == ("warning", f"did you mean {meant}?")
    assert finding.text.endswith(": 2")
    assert finding.span is not None
    assert finding.span.line == 2


def test_a_list_with_nothing_but_a_misspelt_kinematic_says_so() -> None:
    with pytest.raises(MachineDataError, match=r"no kinematic.*line 2: did you mean trafo\?"):
        machine("kinematik_id 9\ntraffo[0].id 9")


def test_unrelated_entries_are_named() -> None:
    text = "trafo[0].id 9\ntraffo[0].id 9\nslope_profil 1\nm_synch[34] 2\nspdl_anzahl 1\nfeed 3\nprog_start.slope 1"
    (finding,) = found(text, "CB206")
    assert finding.severity == "info"
    assert ": 5; the first: slope_profil, m_synch[34], spdl_anzahl" in finding.text


@pytest.mark.parametrize(
    "written", ["trafo[ 0 ].param[6] 1", "trafo [0].param[6] 1", "trafo[0] .param[6] 1", "Trafo[0].Param[ 6] 1"]
)
def test_blanks_in_a_name_are_refused_with_the_name_without(written: str) -> None:
    with pytest.raises(ChainbuildError, match=r"(?i)did you mean trafo\[0\]\.param\[6\]\?") as caught:
        machine(f"trafo[0].id 9\n{written}")
    assert caught.value.line == 2


def test_names_in_capitals_are_the_same() -> None:
    chain = machine("TRAFO[0].ID 45\nTrafo[0].Param[7] 4550000\nTRAFO[0].PARAM[8] 4200000").chain()
    assert codes(chain) == []


def test_equal_repeats_are_counted() -> None:
    text = "trafo[0].id 9\ntrafo[0].param[1] 5 first\ntrafo[0].param[1] 5.0\ntrafo[0].id 9\ntrafo[0].param[1] 6"
    reading = machine(text)
    assert [code for code in codes(reading) if code in ("CB205", "CB214")] == ["CB205", "CB214"]
    (finding,) = [finding for finding in reading.findings if finding.code == "CB214"]
    assert (finding.severity, finding.text[-3:]) == ("info", ": 2")


# ---------------------------------------------------------------- counts


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("trafo[0].param[9] 455.0", "455 is 0.0455 mm: counts are 1e-4 mm"),
        ("trafo[0].param[13] -90.5", "-90.5 is -0.00905 deg: counts are 1e-4 deg"),
        ("wz[1].laenge 120.5", "0.01205 mm"),
        ("trafo[0].base[2] .5", "5e-05 mm"),
    ],
)
def test_a_fraction_of_a_small_count(line: str, words: str) -> None:
    (finding,) = found(kin_45(ARMS, line), "CB510")
    assert finding.severity == "warning"
    assert words in finding.text


def test_the_count_that_may_be_meant() -> None:
    (finding,) = found(kin_45(ARMS, "trafo[0].param[9] 455.0"), "CB510")
    assert finding.hint == "455 mm would be 4550000"


@pytest.mark.parametrize(
    "line",
    ["trafo[0].param[9] 4550000.0", "trafo[0].param[9] 0.0", "trafo[0].param[9] 455", "trafo[0].param[9] 1000.5",
     "trafo[0].param[20] 1.0", "trafo[0].param[9] 900000 mm-value", "trafo[0].param[9] 900000 in the hand",
     "trafo[0].param[9] 900000 ( mm )"],
)  # fmt: skip
def test_counts_that_leave_no_doubt(line: str) -> None:
    assert codes(machine(kin_45(ARMS, line)).chain()) == []


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (
            "trafo[0].param[9] 90.0 mm",
            "'mm' behind the value of trafo[0].param[9] is read as a comment; 90 is 0.009 mm",
        ),
        ("trafo[0].param[9] 900000 mm (hand", "900000 is 90 mm"),
        ("trafo[0].param[13] -90\tdeg", "-90 is -0.009 deg"),
        ("trafo[0].param[20] 1 deg", "read as a comment"),
    ],
)
def test_a_unit_behind_a_value(line: str, words: str) -> None:
    chain = machine(kin_45(ARMS, line)).chain()
    assert codes(chain) == ["CB511"]
    assert words in chain.findings[0].text


def test_counts_of_a_tool_and_of_a_universal_kinematic() -> None:
    text = kin_45(ARMS, "wz[2].kinematic.param[0] 12.5")
    assert found(text, "CB510") == []  # the unit depends on the kinematic that is used
    chain = machine(text, overlay=Overlay(tool={"number": 2.0})).chain()
    assert [finding.parameter for finding in chain.findings if finding.code == "CB510"] == ["wz[2].kinematic.param[0]"]
    universal = machine("trafo[0].id 91\ntrafo[0].param[3] 12.5\ntrafo[0].zero_position[1] 2.5\ntrafo[0].param[0] 0.5")
    assert [f.parameter for f in universal.findings] == ["trafo[0].param[3]", "trafo[0].zero_position[1]"]


def test_limits_in_degrees(tmp_path: Path) -> None:
    path = tmp_path / "axis.lis"
    path.write_text("kopf.achs_nr 1\nkenngr.swe_neg -170.0\nkenngr.swe_pos 170.0\n")
    reading = machine(kin_45(ARMS), overlay=Overlay(axis_lists=(path,)))
    assert codes(reading) == ["CB510", "CB510"]
    assert "-170 is -0.017 mm or deg" in reading.findings[0].text


# ---------------------------------------------------------------- arms


@pytest.mark.parametrize(
    ("kin", "params", "expected"),
    [
        (36, {2: 4000000, 3: 0}, ["CB512"]),
        (36, {2: 4000000, 3: 3000000}, []),
        (45, {8: 0, 9: 4200000}, ["CB512"]),
        (45, {8: 4550000, 9: 42}, ["CB513"]),
        (45, {8: 4550000, 9: 0, 12: 4200000}, []),
        (45, {8: 455, 9: 420}, ["CB514"]),
        (96, {3: 9000000, 5: 0}, ["CB512"]),
        (213, {8: 9000000000, 9: 9000000000}, ["CB514"]),
    ],
)
def test_strange_arms(kin: int, params: dict[int, float], expected: list[str]) -> None:
    lines = [f"trafo[0].id {kin}", *(f"trafo[0].param[{n - 1}] {value}" for n, value in params.items())]
    chain = machine("\n".join(lines)).chain()
    assert [code for code in codes(chain) if code.startswith("CB51")] == expected
    assert all(finding.severity == "warning" for finding in chain.findings if finding.code.startswith("CB51"))


# ---------------------------------------------------------------- tools and channels


def test_tools_of_which_none_is_active() -> None:
    text = kin_45(ARMS, "wz[2].laenge 1200000\nwz[5].laenge 500000")
    (finding,) = found(text, "CB246")
    assert finding.severity == "info"
    assert "wz[2] (120 mm), wz[5] (50 mm)" in finding.text
    assert finding.hint == "choose one in the overlay: [tool] number = 2"
    assert codes(machine(text, overlay=Overlay(tool={"number": 5.0}))) == []


TWO_CHANNELS = """<?xml version="1.0"?>
<TcSmProject><Project><Cnc>
<Channel><Name>One</Name><SdaMds><![CDATA[trafo[0].id 9
]]></SdaMds></Channel>
<Channel><Name>Two</Name><SdaMds><![CDATA[trafo[0].id 58
]]></SdaMds></Channel>
</Cnc></Project></TcSmProject>
"""


def test_several_channels(tmp_path: Path) -> None:
    path = tmp_path / "two.tsproj"
    path.write_text(TWO_CHANNELS)
    reading = machine(TWO_CHANNELS)
    assert len(reading.channels) == 2
    assert "CB406" in codes(reading.chain())
    assert [finding.code for finding in check(path)].count("CB406") == 1
    with pytest.raises(MachineDataError, match=r"channel 0 configures no kinematic 58.*it is in channel 1"):
        reading.chain(kinematic=58)


def test_check_names_assumed_limits_once(tmp_path: Path) -> None:
    path = tmp_path / "arm.lis"
    path.write_text(kin_45(ARMS, "trafo[1].id 9"))
    (finding,) = [finding for finding in check(path) if finding.code == "CB501"]
    assert (finding.severity, "C1, B1, B2, A1, B3, A2" in finding.text) == ("info", True)
    path.with_name("arm.chainbuild.toml").write_text("[limits]\nC1 = [-10, 10]\n")
    (finding,) = [finding for finding in check(path) if finding.code == "CB501"]
    assert "for B1, B2, A1, B3, A2:" in finding.text
