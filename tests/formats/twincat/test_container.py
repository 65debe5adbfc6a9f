"""Parameter lists inside TwinCAT projects."""

from __future__ import annotations

import pytest

from chainbuild.chain.elements import Axis
from chainbuild.errors import ChainbuildError, MachineDataError, ParseError
from chainbuild.formats.text import SourceText, is_xml
from chainbuild.formats.twincat.lists.container import read_container
from tests.kit.twincat_files import codes, machine

ROBOT = "trafo[0].id 45\ntrafo[0].param[6] 4000000\nEnde"


def axis(name: str, lower: float, upper: float, *, index: str = "", extra: str = "") -> str:
    return (
        f"<Axis><Name>{name}</Name>{f'<DefaultIndex>{index}</DefaultIndex>' if index else ''}<AxisPara>"
        f"<AchsMds><![CDATA[\nkenngr.swe_pos {upper:.0f} ( P-AXIS-00178\nkenngr.swe_neg {lower:.0f}\n{extra}\nEnde\n]]>"
        "</AchsMds></AxisPara></Axis>"
    )


def project(*channels: str, axes: str = "") -> str:
    inner = "\n".join(
        f"<Channel><Name>K{n}</Name><SdaMds><![CDATA[{text}]]></SdaMds></Channel>" for n, text in enumerate(channels, 1)
    )
    return f'<?xml version="1.0"?>\n<TcSmProject>\n{inner}\n{axes}\n</TcSmProject>'


def limits(axes: tuple[Axis, ...]) -> list[tuple[float, float]]:
    return [(axis.lower, axis.upper) for axis in axes]


def test_a_list_is_read_with_the_lines_of_the_container() -> None:
    found = machine(project("\n" + ROBOT))
    (trafo,) = found.channels[0].trafos
    assert (trafo.type, trafo.params[6].value) == (45, 4000000)
    assert trafo.span.line == 4
    assert trafo.params[6].span.line == 5
    assert found.channels[0].name == "K1"


def test_errors_point_into_the_container() -> None:
    with pytest.raises(ParseError) as caught:
        machine(project("\n# comment\ntrafo[0].id 45\ntrafo[0].param[6] 1,5\n"))
    assert caught.value.line == 6
    assert "decimal comma" in str(caught.value)


def test_escaped_text_counts_as_well() -> None:
    text = "<TcSmItem><SdaMds>trafo[0].id 45\ntrafo[0].name A&amp;B\n</SdaMds></TcSmItem>"
    (trafo,) = machine(text).channels[0].trafos
    assert trafo.name == "A&B"
    assert trafo.span.line == 1


def test_a_cdata_section_may_hold_marks_of_xml() -> None:
    text = "<a><SdaMds><![CDATA[# if a < b & c > d\ntrafo[0].id 45\n]]></SdaMds></a>"
    assert machine(text).channels[0].trafos[0].id == 45


def test_the_declared_encoding_does_not_matter_any_more() -> None:
    text = '<?xml version="1.0" encoding="iso-8859-1"?><a><SdaMds>trafo[0].id 45\ntrafo[0].name Tür</SdaMds></a>'
    assert machine(text).channels[0].trafos[0].name == "Tür"


def test_several_channels() -> None:
    found = machine(project("spdl_anzahl 1\nEnde", ROBOT, ROBOT.replace("4000000", "5000000")))
    assert [(e.channel, e.id) for e in found.kinematics()] == [(1, 45), (2, 45)]
    chain = found.chain()
    assert "CB406" in codes(chain)
    assert chain.joints[1].T_parent_joint[2, 3] == 0.4
    assert found.chain(channel=2).joints[1].T_parent_joint[2, 3] == 0.5
    with pytest.raises(ChainbuildError, match="configures no kinematic"):
        found.chain(channel=0)
    with pytest.raises(ChainbuildError, match=r"no channel 7.*permitted: 0, 1, 2"):
        found.chain(channel=7)


def test_limits_by_the_names_of_the_channel_list() -> None:
    names = ["A1", "A2", "A3", "A4", "A5", "A6"]
    channel = ROBOT + "\n" + "\n".join(f"gruppe[0].achse[{i}].bezeichnung {name}" for i, name in enumerate(names))
    channel = channel.replace("Ende", "")
    lists = "".join(axis(name, -1_000_000 - i, 900_000 + i) for i, name in reversed(list(enumerate(names))))
    axes = machine(project(channel, axes=lists)).chain().axes
    assert limits(axes) == [(-100 - i / 1e4, 90 + i / 1e4) for i in range(6)]
    assert not any(a.assumed for a in axes)
    assert [a.name for a in axes] == names
    assert [a.generic for a in axes] == ["C1", "B1", "B2", "A1", "B3", "A2"]


def test_limits_by_logical_numbers() -> None:
    channel = ROBOT.replace("Ende", "gruppe[0].achse[0].log_achs_nr 7\ngruppe[0].achse[1].log_achs_nr 3")
    lists = axis("Axis 1", -30000, 30000, extra="kopf.achs_nr 3") + axis(
        "Axis 2", -70000, 70000, extra="kopf.achs_nr 7"
    )
    axes = machine(project(channel, axes=lists)).chain().axes
    assert limits(axes)[:2] == [(-7, 7), (-3, 3)]
    assert [a.assumed for a in axes] == [False, False, True, True, True, True]


def test_limits_by_channel_index() -> None:
    lists = axis("Axis 9", -10000, 10000, index="1") + axis("Axis 8", -20000, 20000, index="0")
    assert limits(machine(project(ROBOT, axes=lists)).chain().axes)[:2] == [(-2, 2), (-1, 1)]


def test_limits_by_the_axis_names_of_the_type() -> None:
    lists = "".join(axis(n, -10000 * i, 10000 * i) for i, n in enumerate(["A2", "B3", "A1", "B2", "B1", "C1"], start=1))
    assert [upper for _, upper in limits(machine(project(ROBOT, axes=lists)).chain().axes)] == [6, 5, 4, 3, 2, 1]


def test_limits_in_channel_order_leave_a_finding() -> None:
    # A1 and A2 are axes 1 and 2 of the robot here, not KIN_TYP 45's axes of that name.
    lists = "".join(axis(f"A{i}", -10000 * i, 10000 * i) for i in range(1, 7))
    chain = machine(project(ROBOT, axes=lists)).chain()
    assert [upper for _, upper in limits(chain.axes)] == [1, 2, 3, 4, 5, 6]
    assert "CB232" in codes(chain)


def test_axes_of_another_channel_are_left_out() -> None:
    lists = axis("C1", -10000, 10000).replace("<Name>", "<DefaultChannel>2</DefaultChannel><Name>")
    assert machine(project(ROBOT, axes=lists)).chain().axes[0].assumed


def test_a_modulo_axis_turns_without_end() -> None:
    axes = machine(project(ROBOT, axes=axis("C1", -10000, 10000, extra="kenngr.achs_mode 0x4"))).chain().axes
    assert axes[0].endless
    assert not axes[1].endless


def test_limits_the_wrong_way_round_are_refused() -> None:
    found = machine(project(ROBOT, axes=axis("C1", 10000, -10000)))
    with pytest.raises(MachineDataError, match=r"C1 leave no range: 1 to -1 deg.*swe_pos above 10000"):
        found.chain()


def test_limits_without_range_are_left_alone() -> None:
    endless = axis("C1", 10000, -10000, extra="kenngr.achs_mode 0x4")
    for lists in (axis("C1", 10000, 10000), endless):
        chain = machine(project(ROBOT, axes=lists)).chain()
        assert chain.axes[0].assumed
        assert "CB230" in codes(chain)


@pytest.mark.parametrize(("key", "side", "limits"), [("neg", "lower", (-5.0, 360.0)), ("pos", "upper", (-360.0, 5.0))])
def test_the_limit_that_is_known_stays(key: str, side: str, limits: tuple[float, float]) -> None:
    both = axis("C1", -50000, 50000)
    lists = "\n".join(line for line in both.splitlines() if f"swe_{'pos' if key == 'neg' else 'neg'}" not in line)
    assert f"swe_{key}" in lists
    chain = machine(project(ROBOT, axes=lists)).chain()
    assert (chain.axes[0].lower, chain.axes[0].upper, chain.axes[0].assumed) == (*limits, True)
    (finding,) = [f for f in chain.findings if f.code == "CB233"]
    assert f"only the {side} software limit" in finding.text
    assert finding.span is not None


def test_a_tool_list_belongs_to_its_channel() -> None:
    tools = "<WerkzD><![CDATA[wz[5].laenge 2000000\nwz[5].radius 54000]]></WerkzD>"
    found = machine(project(ROBOT).replace("</SdaMds>", "</SdaMds>" + tools))
    assert found._tools[0][5].length_mm == 200


@pytest.mark.parametrize("text", ["<?xml version='1.0'?><a/>", "\n <TcSmItem>", "<!-- x --><a/>", "<!DOCTYPE a>"])
def test_xml_is_recognised(text: str) -> None:
    assert is_xml(text)


def test_a_list_is_no_xml() -> None:
    assert not is_xml("trafo[0].id 45")


def test_lenient_reading_of_a_broken_project() -> None:
    found = machine("<TcSmItem><SdaMds><![CDATA[trafo[0].id 45", strict=False)
    assert codes(found) == ["CB210"]
    assert found.kinematics() == ()
    with pytest.raises(ChainbuildError, match="not closed"):
        found.chain()


def test_deep_nesting_is_refused() -> None:
    with pytest.raises(ParseError, match="too deeply"):
        read_container(SourceText("deep.xti", "<a>" * 100_000, "utf-8"))
