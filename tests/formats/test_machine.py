"""`Machine.chain` is one method for both dialects: the same questions, the same strictness, one translation a load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import pytest

import chainbuild
from chainbuild import tolerances
from chainbuild.errors import (
    ChainbuildError,
    ChainError,
    ConventionError,
    MachineDataError,
    UnsupportedKinematicError,
)
from chainbuild.findings import Collector
from chainbuild.formats.load import find_overlay
from chainbuild.formats.machine import Machine
from chainbuild.formats.sinumerik import machine as robx_machine
from chainbuild.formats.text import read_source
from chainbuild.formats.twincat import files as twincat_files
from chainbuild.formats.twincat import machine as twincat_machine
from tests.kit.machine_files import machine_file
from tests.kit.robx_files import NR6, robx_text


@dataclass(frozen=True)
class Dialect:
    """A dialect and files written in it.

    Attributes:
        reads: Reads a file.
        module: Where a machine calls `translate`.
        good: A default kinematic that uses a convention, and another one.
        choice: The convention, and a choice that is not the default.
        refused_value: `good` with a value that reading refuses, whichever kinematic is asked for.
        refused_data: Values that are all read, but make no machine, and the code of this error.
        two_errors: A kinematic with two errors.
        second: What `good` configures beside its default, as an overlay names it.
        unknown_kinematic: Code and alarm.
        unknown_channel: Code.
        unused: Code of a convention that has no effect.
    """

    reads: Callable[..., Machine]
    module: ModuleType
    good: str
    choice: tuple[str, str]
    refused_value: str
    refused_data: tuple[str, str]
    two_errors: str
    second: str
    unknown_kinematic: tuple[str | None, int | None]
    unknown_channel: str | None
    unused: str


_ROBX = {**NR6, "TFL_EXT_RPY": (0, 30, 0)}
_REVERSED = "$MA_POS_LIMIT_MINUS[AX{0}]=5\n$MA_POS_LIMIT_PLUS[AX{0}]=-5\n"
_ARM = "trafo[0].id 45\ntrafo[0].param[7] 8000000\ntrafo[0].param[8] 9000000\ntrafo[0].param[33] 3\n"
_LIST = f"ori_rotation_angle 1\n{_ARM}trafo[1].id 9\n"
DIALECTS = {
    "ROBX": Dialect(
        reads=robx_machine.read_machine,
        module=robx_machine,
        good=robx_text(_ROBX),
        choice=("tfl_ext", "after_fl"),
        refused_value=robx_text(_ROBX, extra="$MC_ROBX_MAMES[0]=nan"),
        refused_data=(robx_text({**NR6, "MAIN_LENGTH_AB": (1, 0), "DHPAR4_5A": (0, 1)}), "CB341"),
        two_errors=robx_text(NR6, extra=_REVERSED.format(1) + _REVERSED.format(2)),
        second='"gripper"',
        unknown_kinematic=(None, None),
        unknown_channel=None,
        unused="CB339",
    ),
    "TwinCAT": Dialect(
        reads=twincat_files.read_machine,
        module=twincat_machine,
        good=_LIST,
        choice=("euler_letters", "a_first"),
        refused_value=_LIST + "trafo[0].param[0] nan\n",
        refused_data=(f"{_ARM}trafo[0].param[20] 7\n", "CB401"),
        two_errors=f"{_ARM}trafo[0].param[20] 7\ntrafo[0].param[21] 8\n",
        second="9",
        unknown_kinematic=("CB404", 21630),
        unknown_channel="CB404",
        unused="CB405",
    ),
}


@pytest.fixture(params=DIALECTS)
def dialect(request: pytest.FixtureRequest) -> Dialect:
    return DIALECTS[request.param]


@pytest.fixture
def translations(dialect: Dialect, monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Return a list that grows by one with every translation."""
    calls: list[object] = []
    translate = dialect.module.translate

    def counted(*arguments: object) -> object:
        calls.append(arguments)
        return translate(*arguments)

    monkeypatch.setattr(dialect.module, "translate", counted)
    return calls


def lenient(dialect: Dialect, path: Path) -> Machine:
    """Read a file as `check` does."""
    return dialect.reads(read_source(path), path, find_overlay(path), Collector(strict=False))


def errors(machine: Machine) -> list[str]:
    return [finding.code for finding in machine.findings if finding.severity == "error"]


# The same questions.


def test_an_unknown_kinematic(dialect: Dialect, tmp_path: Path) -> None:
    path = machine_file(tmp_path, dialect.good)
    for machine in (chainbuild.load(path), lenient(dialect, path)):
        for ask in (machine.chain, machine.parameters):
            with pytest.raises(MachineDataError, match="configures no kinematic 77") as caught:
                ask(77)
            assert (caught.value.parameter, caught.value.file) == ("kinematic", str(path))
            assert (caught.value.code, caught.value.alarm) == dialect.unknown_kinematic


def test_an_unknown_kinematic_of_the_overlay(dialect: Dialect, tmp_path: Path) -> None:
    path = machine_file(tmp_path, dialect.good, "kinematic = 77\n")
    machine = chainbuild.load(path)
    with pytest.raises(MachineDataError, match="configures no kinematic 77") as caught:
        machine.chain()
    assert (caught.value.code, caught.value.alarm) == dialect.unknown_kinematic
    assert caught.value.file == str(tmp_path / "machine.chainbuild.toml")
    assert machine.chain(machine.kinematics()[0].id).axes


def test_an_unknown_channel(dialect: Dialect, tmp_path: Path) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    known = str(machine.kinematics()[0].channel)
    for ask in (machine.chain, machine.parameters):
        with pytest.raises(MachineDataError, match="channel 9") as caught:
            ask(channel=9)
        found = caught.value
        assert (found.parameter, found.permitted, found.code) == ("channel", known, dialect.unknown_channel)


@pytest.mark.parametrize("length", [float("nan"), float("inf"), tolerances.HUGE_AXIS_VALUE, "5", None])
def test_a_tool_length_that_is_none(dialect: Dialect, length: float, tmp_path: Path) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    with pytest.raises(MachineDataError, match="the tool length") as caught:
        machine.chain(tool_length_mm=length)
    assert caught.value.parameter == "tool_length_mm"


def test_conventions_that_do_not_exist(dialect: Dialect, tmp_path: Path) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    name, _ = dialect.choice
    with pytest.raises(ConventionError, match="unknown convention 'no_such'"):
        machine.chain(conventions={"no_such": "x"})
    with pytest.raises(ConventionError, match="has no choice 'no_such'"):
        machine.chain(conventions={name: "no_such"})
    with pytest.raises(ConventionError, match="mapping"):
        machine.chain(conventions=[name])  # type: ignore[arg-type]


def test_a_convention_that_is_used(dialect: Dialect, tmp_path: Path) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    name, choice = dialect.choice
    usual, chosen = machine.chain(), machine.chain(conventions={name: choice})
    used = {one.convention.name: (one.choice, one.by_user) for one in chosen.conventions}
    assert used[name] == (choice, True)
    assert [(one.choice, one.by_user) for one in usual.conventions if one.convention.name == name] != [(choice, True)]
    assert chosen.findings == usual.findings
    by_overlay = chainbuild.load(machine_file(tmp_path, dialect.good, f'[conventions]\n{name} = "{choice}"\n'))
    assert by_overlay.chain().conventions == chosen.conventions


def test_a_convention_that_is_not_used(dialect: Dialect, tmp_path: Path) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    usual, other = machine.chain(), machine.chain(conventions={"tfl_ext": "after_fl", "kin98_carrier": "refused"})
    added = other.findings[len(usual.findings) :]
    assert other.findings[: len(usual.findings)] == usual.findings
    assert {(finding.code, finding.severity) for finding in added} == {(dialect.unused, "info")}
    assert all("kin98_carrier" in finding.text or "tfl_ext" in finding.text for finding in added)
    assert machine.findings == chainbuild.load(machine.path).findings


# The same strictness.


def test_a_value_that_reading_refuses(dialect: Dialect, tmp_path: Path) -> None:
    path = machine_file(tmp_path, dialect.refused_value)
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.load(path)
    machine = lenient(dialect, path)
    assert errors(machine) == [caught.value.code]
    for entry in machine.kinematics():
        with pytest.raises(MachineDataError) as again:
            machine.chain(entry.id)
        assert (again.value.code, again.value.span) == (caught.value.code, caught.value.span)
    found = [finding for finding in chainbuild.check(path) if finding.severity == "error"]
    assert [(one.code, one.span) for one in found] == [(caught.value.code, caught.value.span)]


def test_data_that_make_no_machine(dialect: Dialect, tmp_path: Path) -> None:
    text, code = dialect.refused_data
    path = machine_file(tmp_path, text)
    with pytest.raises(MachineDataError) as caught:
        chainbuild.load(path).chain()
    assert caught.value.code == code
    machine = lenient(dialect, path)
    for _ in range(2):
        with pytest.raises(MachineDataError) as again:
            machine.chain()
        assert (again.value.message, again.value.span) == (caught.value.message, caught.value.span)
    found = errors(machine)
    assert found[0] == code
    assert [one.code for one in chainbuild.check(path) if one.severity == "error"] == found


def test_a_lenient_machine_goes_on_to_find_more(dialect: Dialect, tmp_path: Path) -> None:
    path = machine_file(tmp_path, dialect.two_errors)
    first, second = (finding for finding in chainbuild.check(path) if finding.severity == "error")
    assert first.text != second.text
    with pytest.raises(MachineDataError) as caught:
        chainbuild.load(path).chain()
    assert caught.value.message == first.text


def test_a_strict_machine_stops_at_the_first_error(
    dialect: Dialect, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    collectors: list[Collector] = []

    def translate(_selected: object, _length: float, _choose: object, collector: Collector) -> None:
        collectors.append(collector)
        for code in ("CB401", "CB304"):
            collector.add(code, code, error=UnsupportedKinematicError)

    monkeypatch.setattr(machine, "_translate", translate)
    with pytest.raises(UnsupportedKinematicError, match="CB401"):
        machine.chain(tool_length_mm=1.0)
    assert collectors[0].findings == []


def test_a_sound_kinematic_beside_a_faulty_one(tmp_path: Path) -> None:
    text = "trafo[0].id 9\ntrafo[1].id 45\ntrafo[1].param[20] 7\n"
    path = machine_file(tmp_path, text)
    for machine in (chainbuild.load(path), lenient(DIALECTS["TwinCAT"], path)):
        for _ in range(2):
            with pytest.raises(MachineDataError, match="HD21"):
                machine.chain(45)
        assert machine.chain(9).kinematic == machine.chain().kinematic == "KIN_TYP 9"
        assert all(finding.severity != "error" for finding in machine.chain(9).findings)


def test_a_chain_that_contradicts_itself_is_refused_when_it_is_translated(
    dialect: Dialect, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    whole = machine._translate

    def broken(*arguments: object) -> chainbuild.Chain:
        chain = whole(*arguments)  # type: ignore[arg-type]
        return replace(chain, frames=chain.frames[1:])

    monkeypatch.setattr(machine, "_translate", broken)
    with pytest.raises(ChainError, match="the chain has no frame"):
        machine.chain(tool_length_mm=1.0)


# One translation a load.


def test_loading_and_asking_translates_once(dialect: Dialect, translations: list[object], tmp_path: Path) -> None:
    machine = chainbuild.load(machine_file(tmp_path, dialect.good))
    chain = machine.chain()
    entry = machine.kinematics()[0]
    for again in (
        machine.chain(),
        machine.chain(entry.id),
        machine.chain(entry.name or str(entry.id), entry.channel),
        machine.chain(tool_length_mm=0, conventions={}),
    ):
        assert again.joints is chain.joints
        assert (again.name, again.findings, again.conventions) == (chain.name, chain.findings, chain.conventions)
    machine.parameters()
    assert len(translations) == 1


def test_other_arguments_are_translated_anew(dialect: Dialect, translations: list[object], tmp_path: Path) -> None:
    name, choice = dialect.choice
    machine = chainbuild.load(
        machine_file(tmp_path, dialect.good, f'tool_length_mm = 20\n[conventions]\n{name} = "{choice}"\n')
    )
    chain = machine.chain()
    assert machine.chain(conventions={name: choice}).joints is chain.joints
    assert len(translations) == 1
    default = next(one.convention.default for one in chain.conventions if one.convention.name == name)
    assert machine.chain(conventions={name: default}).conventions != chain.conventions
    longer = machine.chain(tool_length_mm=5.0)
    shift = longer.frame("tool").T_link_frame[:3, 3] - chain.frame("tool").T_link_frame[:3, 3]
    assert (shift**2).sum() == pytest.approx(0.005**2)
    assert len(translations) == 3
    assert machine.chain().joints is chain.joints
    assert machine.chain(machine.kinematics()[1].name or 9).joints is not chain.joints
    assert len(translations) == 4


@pytest.mark.parametrize("overlay", ["", "kinematic = {second}\n"])
def test_check_translates_each_kinematic_once(
    dialect: Dialect, overlay: str, translations: list[object], tmp_path: Path
) -> None:
    path = machine_file(tmp_path, dialect.good, overlay.format(second=dialect.second))
    found = chainbuild.check(path)
    assert all(finding.severity != "error" for finding in found)
    assert len(translations) == len(chainbuild.load(path).kinematics())


def test_check_translates_a_faulty_kinematic_once(dialect: Dialect, translations: list[object], tmp_path: Path) -> None:
    text, code = dialect.refused_data
    found = chainbuild.check(machine_file(tmp_path, text))
    assert code in {finding.code for finding in found}
    assert len(translations) == len(lenient(dialect, tmp_path / "machine.txt").kinematics())
