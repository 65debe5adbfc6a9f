"""The TwinCAT machine as a whole: dialect, parameters, conventions, angle modes."""

from __future__ import annotations

import pytest

from chainbuild.errors import ChainbuildError, MachineDataError
from chainbuild.formats.text import is_twincat
from tests.kit.twincat_files import codes, kin_45, machine


@pytest.mark.parametrize(
    "text",
    ["trafo[0].id 45", "# c\n\tkin_step[0].trafo[0].id 1", "kinematik[9].param[0] 1", "kinematik_id 3",
     "wz[1].laenge 5", "<TcSmItem/>", "trafo[0.id 45", "kenngr.swe_neg 5"],
)  # fmt: skip
def test_the_dialect_is_told_by_content(text: str) -> None:
    assert is_twincat(text)


@pytest.mark.parametrize(
    "text", ["$MC_ROBX_NUM_AXES=6", "N24100 $MC_TRAFO_TYPE_1=4100", "hello\nworld", "", "trafos 3"]
)
def test_other_texts_are_not_ours(text: str) -> None:
    assert not is_twincat(text)


def test_parameters_explain_the_file() -> None:
    text = kin_45({7: 4000000, 14: -900000, 21: 1, 13: 5}, "trafo[0].base[2] -5 (mm\nori_rotation_angle 2")
    found = machine(text)
    rows = {row.symbol or row.name: row for row in found.parameters()}
    assert (rows["HD7"].value, rows["HD7"].unit, rows["HD7"].given) == (400, "mm", True)
    assert rows["HD7"].name == "trafo[0].param[6]"
    assert rows["HD7"].span is not None
    assert rows["HD7"].span.line == 2
    assert (rows["HD14"].value, rows["HD14"].unit) == (-90, "deg")
    assert (rows["HD21"].value, rows["HD21"].unit) == (1, "")
    assert (rows["HD8"].value, rows["HD8"].given, rows["HD8"].span) == (0, False, None)
    assert "not in the table" in rows["HD13"].meaning
    assert (rows["trafo[0].base[2]"].value, rows["trafo[0].base[2]"].unit) == (-0.0005, "mm")
    assert (rows["P-CHAN-00112"].value, rows["P-CHAN-00112"].given) == (2, True)
    assert "KIN_TYP manual 3.3" in rows["HD7"].source
    assert "CB403" in codes(found.chain())


def test_unused_conventions_are_named() -> None:
    assert "CB405" in codes(machine(kin_45({})).chain(conventions={"offset_inside_flag": "inside"}))
    with pytest.raises(ChainbuildError, match="unknown convention"):
        machine(kin_45({})).chain(conventions={"nonsense": "x"})


@pytest.mark.parametrize("length", [float("nan"), float("inf"), "5", True, None])
def test_a_tool_length_that_is_none(length: object) -> None:
    with pytest.raises(MachineDataError, match="tool length"):
        machine(kin_45({})).chain(tool_length_mm=length)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("number", "mode", "code"),
    [(None, "ypr", None), (0, "ypr", None), (1, "euler_c_first", None), (2, "cba", None), (3, "cab", None),
     (4, "cba_std", None), (5, "abc", None), (14, "ab", None), (15, "ba", None),
     (-1, "ypr", "CB408"), (12, "ypr", "CB409")],
)  # fmt: skip
def test_angle_modes(number: int | None, mode: str, code: str | None) -> None:
    arms = {8: 4550000.0, 9: 4200000.0}
    chain = machine(kin_45(arms, "" if number is None else f"ori_rotation_angle {number}")).chain()
    assert chain.angle_mode == mode
    assert codes(chain) == ([code] if code else [])


def test_euler_letters() -> None:
    chain = machine(kin_45({}, "ori_rotation_angle 1")).chain(conventions={"euler_letters": "c_first"})
    assert chain.angle_mode == "euler_c_first"
    assert [used.convention.name for used in chain.conventions] == ["euler_letters", "ori_vector_axis"]
