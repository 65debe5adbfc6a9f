"""The catalogue: what is built, what is refused and how, and the register of finding numbers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import chainbuild
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError, Span, UnsupportedKinematicError
from chainbuild.findings import Collector, finding_kinds
from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, table_flag, table_rotary, zero_and_sign
from chainbuild.formats.twincat.types.catalogue import catalogue, kin_type, title_of, why_unsupported

PACKAGE = Path(chainbuild.__file__).parent / "formats" / "twincat"


def test_kin_45_is_built() -> None:
    kind = catalogue()[45]
    assert (kind.number, kind.title, kind.family, kind.orientation) == (
        45,
        "Six-axis articulated robot",
        "arm",
        "complete",
    )
    assert [axis.name for axis in kind.axes] == ["C1", "B1", "B2", "A1", "B3", "A2"]
    assert kind.hd[6].name == "base_to_b1_z"
    assert {"offset_inside_flag", "flange_variant_2", "kin45_length_frame", "euler_letters"} <= {
        convention.name for convention in kind.conventions
    }


@pytest.mark.parametrize(
    ("number", "family", "orientation"), [(91, "universal", "listed"), (210, "coupling", "complete")]
)
def test_types_that_are_lists(number: int, family: str, orientation: str) -> None:
    kind = chainbuild.catalogue()[number]
    assert (kind.number, kind.family, kind.orientation, kind.listed) == (number, family, orientation, True)
    assert (kind.axes, kind.hd) == ((), ())
    assert "no table of head offsets" in kind.summary
    assert kind.title == title_of(number)
    assert f"kin{number}_" in " ".join(one.name for one in kind.conventions)
    assert repr(kind) == f"<KinType {number}: {kind.title}; axes as listed; 0 HD parameters>"
    assert kin_type(number) is kind
    with pytest.raises(UnsupportedKinematicError, match="not built from head offsets"):
        kind.recipe(Params(kind.data), Choices())
    assert sorted(n for n, one in catalogue().items() if one.listed) == [91, 210]
    assert all(one.axes for one in catalogue().values() if not one.listed)


def test_every_type_of_the_catalogue_has_data() -> None:
    assert set(catalogue()) <= set(type_data())
    assert list(catalogue()) == sorted(catalogue())
    assert chainbuild.catalogue() is catalogue()


@pytest.mark.parametrize("number", [15, 78, 79, 90, 93])
def test_tube_processing_is_refused_by_name(number: int) -> None:
    with pytest.raises(UnsupportedKinematicError, match=rf"KIN_TYP {number} \(tube processing\)") as caught:
        kin_type(number, Span("a.lis", 3))
    assert caught.value.line == 3
    assert title_of(number) == "Tube processing"


@pytest.mark.parametrize("number", [12, 19, 21, 37, 209])
def test_parallel_kinematics_are_known(number: int) -> None:
    assert number in catalogue() or "parallel kinematic" in str(why_unsupported(number))
    assert title_of(number) != "unknown type"


@pytest.mark.parametrize("number", [0, 20, 65535])
def test_unknown_numbers_list_the_known_ones(number: int) -> None:
    with pytest.raises(UnsupportedKinematicError, match="is unknown") as caught:
        kin_type(number)
    assert str(caught.value.permitted).startswith("KIN_TYP ")
    assert "45" in str(caught.value.permitted)


def test_every_finding_number_is_registered() -> None:
    used = {code for path in PACKAGE.rglob("*.py") for code in re.findall(r'"(CB\d{3})"', path.read_text("utf-8"))}
    assert used
    assert used <= set(finding_kinds())


# ---------------------------------------------------------------- recipe helpers


@pytest.mark.parametrize(
    ("choice", "printed", "expected"),
    [
        ("as_printed", "inside", Drive(-1, 10)),
        ("as_printed", "outside", Drive(-1, -10)),
        ("inside", "outside", Drive(-1, 10)),
        ("outside", "inside", Drive(-1, -10)),
    ],
)
def test_zero_and_sign(choice: str, printed: str, expected: Drive) -> None:
    choose = Choices({"offset_inside_flag": choice})
    drive = zero_and_sign(choose, -1.0, 10.0, printed=printed)  # type: ignore[arg-type]
    assert drive == expected
    assert zero_and_sign(choose, 1.0, 10.0, printed="inside") == Drive(1, -10)


@pytest.mark.parametrize(("choice", "sign", "offset"), [("right_handed", 1, -5), ("left_handed", -1, 5)])
def test_table_rotary_sense(choice: str, sign: float, offset: float) -> None:
    move = table_rotary(Choices({"table_rotary_sense": choice}), "A", "x", zero_deg=5.0)
    assert (move.drive, move.offset) == ({"A": sign}, offset)
    head = table_rotary(Choices({"table_rotary_sense": choice}), "B", "y", zero_deg=5.0, carries="tool")
    assert (head.drive, head.offset) == ({"B": 1}, -5)


@pytest.mark.parametrize(
    ("coding", "value", "sign"),
    [("zero_one", 0, 1), ("zero_one", 1, -1), ("zero_one", -1, -1), ("plus_minus_one", 0, 1), ("plus_minus_one", 1, 1),
     ("plus_minus_one", -1, -1)],
)  # fmt: skip
def test_table_flag(coding: str, value: float, sign: float) -> None:
    assert table_flag(Params(type_data()[58], {12: value}), Choices({"table_flag_coding": coding}), 12) == sign


def test_params_are_scaled_and_checked() -> None:
    p = Params(type_data()[45], {7: 4000000, 14: -900000, 21: 1, 22: 3})
    assert (p.mm("base_to_b1_z"), p.mm(7), p.deg("offset_b1"), p.direction(21)) == (400, 400, -90, -1)
    assert (p.mm(8), p.given(8), p.given(7)) == (0, False, True)
    with pytest.raises(MachineDataError, match="HD22 is 3"):
        p.flag(22)
    for wrong in (lambda: p.mm(14), lambda: p.deg(7), lambda: p.number(7)):
        with pytest.raises(TypeError):
            wrong()
    with pytest.raises(KeyError):
        p.mm("no_such")


@pytest.mark.parametrize(("value", "sign", "found"), [(-1, -1, []), (0, 1, ["CB402"]), (1, 1, []), (-0.5, -1, [])])
def test_signs(value: float, sign: float, found: list[str]) -> None:
    collector = Collector()
    p = Params(type_data()[16], {9: value}, collector=collector)
    assert p.sign(9) == sign
    assert [finding.code for finding in collector.findings] == found
    assert p.sign(9, zero_is_plus=True) == sign
