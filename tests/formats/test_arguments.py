"""Arguments of every wrong kind end in a ChainbuildError that says what would be accepted."""

from __future__ import annotations

import decimal
import fractions
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, ConventionError, FileAccessError, MachineDataError

LIST = "trafo[0].id 9\ntrafo[1].id 58\ntrafo[1].name TABLE\n"
HUGE = 10**5000


@pytest.fixture(scope="module", params=["twincat", "robx"])
def machine(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> chainbuild.Machine:
    if request.param == "robx":
        return chainbuild.load("irb2600")
    path = tmp_path_factory.mktemp("arguments") / "two.lis"
    path.write_text(LIST, "utf-8")
    return chainbuild.load(path)


NO_KINEMATICS = ["", "²", "١", " 9", "9.0", True, False, 1.0, b"9", [], {}, np.array([1]), np.bool_(True), HUGE, -1,
                 float("nan"), "9" * 5000, 1j, object()]  # fmt: skip


@pytest.mark.parametrize("kinematic", NO_KINEMATICS, ids=lambda value: type(value).__name__)
def test_what_names_no_kinematic(machine: chainbuild.Machine, kinematic: object) -> None:
    for call in (machine.chain, machine.parameters):
        with pytest.raises(MachineDataError, match=r"is not a kinematic|configures no kinematic"):
            call(kinematic)  # type: ignore[operator]


@pytest.mark.parametrize("kind", [int, np.int8, np.uint64, np.array, str])
def test_what_names_one(machine: chainbuild.Machine, kind: type) -> None:
    number = machine.kinematics()[0].id
    assert machine.chain(kind(number)).name == machine.chain().name


@pytest.mark.parametrize(
    "channel", [np.array([0, 1]), True, "0", 0.0, [], HUGE, 99, -1], ids=lambda v: type(v).__name__
)
def test_what_names_no_channel(machine: chainbuild.Machine, channel: object) -> None:
    for call in (machine.chain, machine.parameters):
        with pytest.raises(MachineDataError, match="channel"):
            call(channel=channel)  # type: ignore[operator]


def test_channels_of_numpy(machine: chainbuild.Machine) -> None:
    number = machine.kinematics()[0].channel
    assert machine.chain(channel=np.int32(number)).name == machine.chain().name  # type: ignore[arg-type]


@pytest.mark.parametrize("conventions", [{"sc": ["a"]}, {1: "a"}, {"sc": None}, {"sc": {}}, [("a", "b")], "x", 5])
def test_what_is_no_convention(machine: chainbuild.Machine, conventions: object) -> None:
    with pytest.raises(ConventionError):
        machine.chain(conventions=conventions)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "length", [5, 5.0, np.float32(5), np.float64(5), np.int16(5), np.array(5.0), np.array(5), fractions.Fraction(5)]
)
def test_any_real_number_is_a_tool_length(machine: chainbuild.Machine, length: float) -> None:
    zero = np.zeros(len(machine.chain().axes))
    longer = chainbuild.Robot(machine.chain(tool_length_mm=length)).fk(zero)
    assert longer.isApprox(chainbuild.Robot(machine.chain(tool_length_mm=5.0)).fk(zero))


@pytest.mark.parametrize(
    ("length", "says"),
    [
        (1e9, "too large"), (-1e10, "too large"), (HUGE, "too large"), (float("nan"), "not finite"),
        (float("-inf"), "not finite"), (True, "no"), (np.bool_(True), "not a number"), ("5", "not a number"),
        (None, "not a number"), ([5.0], "not a number"), (np.array([5.0]), "not a number"), (1j, "not a number"),
        (decimal.Decimal(5), "not a number"),
    ],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_what_is_no_tool_length(machine: chainbuild.Machine, length: object, says: str) -> None:
    with pytest.raises(MachineDataError, match=says) as caught:
        machine.chain(tool_length_mm=length)  # type: ignore[arg-type]
    assert caught.value.parameter == "tool_length_mm"


NO_PATHS = (5, [], b"x", True, 1.5, object(), "", "\0", "no\0where.lis")


@pytest.mark.parametrize("path", NO_PATHS, ids=lambda path: repr(path)[:12])
def test_what_is_no_path(path: object) -> None:
    with pytest.raises(FileAccessError):
        chainbuild.load(path)  # type: ignore[arg-type]
    with pytest.raises(FileAccessError):
        chainbuild.check(path)  # type: ignore[arg-type]
    for call in (chainbuild.load, chainbuild.check):
        with pytest.raises(FileAccessError):
            call("irb2600", overlay=path)  # type: ignore[operator]


def test_where_no_urdf_can_be_written(machine: chainbuild.Machine, tmp_path: Path) -> None:
    robot = chainbuild.Robot(machine.chain())
    for folder in (5, None, True, b"x", [], str(tmp_path / "a\0b"), "/dev/null/x"):
        with pytest.raises(FileAccessError):
            chainbuild.write_urdf(robot, folder)  # type: ignore[arg-type]
    for thing in (None, 5, machine, machine.chain()):
        with pytest.raises(ChainbuildError, match=r"expected a robot, got .*chainbuild\.Robot"):
            chainbuild.write_urdf(thing, tmp_path)  # type: ignore[arg-type]
