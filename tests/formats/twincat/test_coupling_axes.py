"""KIN_TYP 210: the axes of the channel, the angle mode of RTCP partials, and where a basic offset puts a partial."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from chainbuild.findings import Finding
from tests.kit.couplings import AT_TABLE, XY
from tests.kit.twincat_files import chain_of, codes, machine
from tests.kit.universal import CA_HEAD, AxisOf91, Universal, X, Y, Z

TCP = [f"{letter}_TCP" for letter in "XYZABC"]
UNIT, ARM = ["X_LIN", "Y_LIN"], [f"{letter}_ROB" for letter in "XYZABC"]
ORDER = "axis indices TCP 0 to 5, LINEAR 6 to 7, ROBOT 8 to 13"


def channel(names: Sequence[str]) -> list[str]:
    return [f"gruppe[0].achse[{i}].bezeichnung {name}" for i, name in enumerate(names)]


def told(lines: Sequence[str], code: str) -> list[Finding]:
    return [finding for finding in chain_of(lines).findings if finding.code == code]


@pytest.mark.parametrize(
    "names",
    [
        [*TCP, *UNIT, *ARM],
        [*TCP, *UNIT, "A1", "A2", "A3", "A4", "A5", "A6"],
        [*TCP, "U", "V", *ARM],
        [f"{name[0]}_{i}_M1" if i < 6 else f"Q{i}_M1" for i, name in enumerate([*TCP, *UNIT, *ARM])],
        [],
    ],
)
def test_channels_in_order(names: Sequence[str]) -> None:
    assert codes(chain_of([*XY, *channel(names)])) == []


@pytest.mark.parametrize(
    ("names", "text"),
    [
        ([*TCP, *ARM, *UNIT], "axis 8 is called Z_ROB, but is the X of ROBOT"),
        ([*UNIT, *ARM, *TCP], "axis 2 is called X_ROB, but is the Z of TCP"),
        ([*TCP, "Y_LIN", "X_LIN", *ARM], "axis 6 is called Y_LIN, but is the X of LINEAR"),
        (
            [*TCP, "X_LIN", "Y_ROB", *ARM[:1], "Y_LIN", *ARM[2:]],
            "axis 6 (X_LIN) belongs to LINEAR, axis 9 (Y_LIN) of the same suffix to ROBOT",
        ),
        ([*UNIT, *ARM], "axis 2 is called X_ROB, but is the Z of TCP"),
        (["x", "y", "z", "a", "b", "c"], "the channel has 6 axes, the coupling needs 14"),
    ],
)
def test_axes_out_of_order(names: Sequence[str], text: str) -> None:
    if len(names) == 8:
        text = "the channel has 8 axes, the coupling needs 14"
    (found,) = told([*XY, *channel(names)], "CB463")
    assert (found.text, found.permitted, found.severity) == (text, ORDER, "warning")
    assert found.parameter == "gruppe[0].achse[i]"


def test_the_second_group_comes_last() -> None:
    names = [*TCP, *UNIT, *ARM, "A_TAB", "C_TAB"]
    assert told([*AT_TABLE, *channel(names)], "CB463") == []
    (found,) = told([*AT_TABLE, *channel([*TCP, "A_TAB", "C_TAB", *UNIT, *ARM])], "CB463")
    assert found.text == "axis 6 is called A_TAB, but is the X of LINEAR"
    assert found.permitted == f"{ORDER}, TABLE 14 to 15"


@pytest.mark.parametrize(
    ("axis", "text", "parameter", "permitted"),
    [
        ("kenngr.antr_typ 2", "its drive type is 2", "kenngr.antr_typ", "4 (simulation)"),
        ("kenngr.antr_typ 16", "its drive type is 16", "kenngr.antr_typ", "4 (simulation)"),
        ("kenngr.messachse 1", "it takes part in measuring", "kenngr.messachse", "0"),
    ],
)
def test_tcp_axes_are_simulated(axis: str, text: str, parameter: str, permitted: str) -> None:
    def findings(extra: str) -> list[Finding]:
        text = "\n".join([*XY, *channel([*TCP, *UNIT, *ARM])])
        limits = "kenngr.swe_neg -10000\nkenngr.swe_pos 10000"
        found = machine(
            f"<TcSmProject><Channel><SdaMds><![CDATA[\n{text}\nEnde\n]]></SdaMds></Channel><Axis><Name>Z_TCP</Name>"
            f"<AxisPara><AchsMds><![CDATA[\n{limits}\n{extra}\nEnde\n]]></AchsMds></AxisPara></Axis></TcSmProject>"
        )
        return [finding for finding in found.chain().findings if finding.code == "CB463"]

    (told_once,) = findings(axis)
    assert told_once.text == f"axis 2 (Z_TCP) is a TCP axis of the coupling, but {text}"
    assert (told_once.parameter, told_once.permitted) == (parameter, permitted)
    assert findings("kenngr.antr_typ 4\nkenngr.messachse 0") == []
    assert findings("") == []


def head(*letters: str, rtcp: int = 1) -> list[str]:
    directions = {"A": (1, 0, 0), "B": (0, 1, 0), "C": (0, 0, 1)}
    rotary = [AxisOf91(2, directions[letter]) for letter in letters]
    universal = Universal([X, Y, Z, *rotary], list(range(3 + len(rotary))), rtcp=rtcp)
    group = ["trafo[2].id 210", "trafo[2].group[0].name G", "trafo[2].group[0].chain[0] HEAD"]
    return [*universal.lines(0, name="HEAD"), *group]


@pytest.mark.parametrize(
    ("letters", "fitting"),
    [
        ("CA", (3,)),
        ("AC", (5,)),
        ("AB", (5, 3)),
        ("BA", (4,)),
        ("CB", (4, 3)),
        ("BC", (5,)),
        ("CAB", (3,)),
        ("ACB", ()),
    ],
)
def test_the_angle_mode_of_an_rtcp_partial(letters: str, fitting: tuple[int, ...]) -> None:
    for mode in (0, 2, 3, 4, 5):
        found = told([*head(*letters), f"ori_rotation_angle {mode}"], "CB464")
        assert bool(found) == (mode not in fitting), (letters, mode)
        for one in found:
            assert one.permitted == (" or ".join(map(str, fitting)) or "none fits")
            assert one.parameter == "ori_rotation_angle"


def test_words_of_an_unfit_angle_mode() -> None:
    (found,) = told(head("C", "A"), "CB464")
    assert found.text == "HEAD turns about C and A; the angle mode 0 (default) does not turn in that order"
    (nine,) = told(["trafo[0].id 9", "trafo[0].name HEAD", *head("C", "A")[-3:], "ori_rotation_angle 5"], "CB464")
    assert nine.text == "HEAD turns about C and A; the angle mode 5 does not turn in that order"
    assert nine.span is not None
    assert nine.span.line == 6


def test_where_no_angle_mode_is_needed() -> None:
    assert told(head("C"), "CB464") == []  # one rotary axis
    assert told(["trafo[0].id 5", "trafo[0].name HEAD", *head("C", "A")[-3:]], "CB464") == []
    assert told(head("C", "A", rtcp=0), "CB464") == []  # a complete transformation
    assert told(AT_TABLE, "CB464") == []  # the table's group carries no TCP
    assert told(XY, "CB464") == []
    assert len(told([*CA_HEAD.lines(0, name="HEAD"), *head("C", "A")[-3:]], "CB464")) == 1


def test_a_basic_offset_says_where_the_partial_stands() -> None:
    # 3.8.2: read literally the table is below the floor.
    lines = [*AT_TABLE, "trafo[3].base[0] 30000000", "trafo[3].base[2] 10000000", "trafo[0].base[2] 200000"]
    texts = [finding.text for finding in told(lines, "CB454")]
    open_ = (
        "the direction in which the basic offset of {} counts is open; as read, its MCS is at X {}, Y 0, Z {} mm in {}"
    )
    assert texts == [
        open_.format("ROBOT", "0", "-20", "the TCP frame of LINEAR"),
        open_.format("TABLE", "-3000", "-1000", "the MCS of the coupling"),
    ]
    # The carrier turned by 90 degrees about Z as seen from the table: X of the offset becomes Y.
    (turned,) = told([*AT_TABLE, "trafo[3].base[0] 30000000", "trafo[3].base[5] 900000"], "CB454")
    assert "at X 0, Y 3000, Z 0 mm" in turned.text
    # 2121.3203 mm along X and Y, turned by 45 degrees, lie along X; rounding leaves no sign at zero.
    for sign, along in ((1, "-3000"), (-1, "3000")):
        base = [f"trafo[3].base[{n}] {sign * 21213203}" for n in (0, 1)]
        (turned,) = told([*AT_TABLE, *base, "trafo[3].base[5] 450000"], "CB454")
        assert f"at X {along}, Y 0, Z 0 mm" in turned.text
