"""KIN_TYP 91 against T = Π M(axis), TCP = T·(zero_position − L·zero_orientation), in every way a list may write it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild.errors import ChainbuildError, MachineDataError
from chainbuild.formats.overlay import Overlay
from chainbuild.robot import Robot
from tests.kit.twincat_files import chain_of, codes, machine, pose
from tests.kit.universal import CA_HEAD, TABLE, AxisOf91, Universal, X, Y, Z, random_universal, rotation, shift


def check(universal: Universal, lines: list[str], rng: np.random.Generator, length_mm: float = 0.0) -> None:
    chain = chain_of(lines, tool_length_mm=length_mm)
    for _ in range(5):
        axes = rng.uniform(-200, 200, len(universal.axes))
        T = pose(chain, axes)
        tip, vector = universal.tip(axes, length_mm)
        assert np.abs(T[:3, 3] - tip).max() < 1e-8
        assert np.abs(T[:3, 2] - vector).max() < 1e-12


@pytest.mark.parametrize("count", [3, 4, 5, 6])
@pytest.mark.parametrize("seed", range(8))
def test_random_lists(count: int, seed: int) -> None:
    rng = np.random.default_rng([count, seed])
    universal = random_universal(rng, count, unit=bool(seed % 2))
    check(universal, universal.lines(), rng, length_mm=73.5)
    check(universal, universal.slots(), rng)


@pytest.mark.parametrize("prefix", ["kin_step[0].trafo[2]", "kinematik[91]", "trafo[9]"])
def test_every_list_syntax(prefix: str) -> None:
    rng = np.random.default_rng(7)
    universal = random_universal(rng, 5)
    check(universal, universal.lines(prefix=prefix), rng)


def test_the_last_axis_of_six_has_the_last_slot() -> None:
    universal = random_universal(np.random.default_rng(1), 6)
    assert universal.slots()[-8].startswith("trafo[0].param[48]")


def test_names_win_over_slots_and_tools_are_added() -> None:
    lines = [*CA_HEAD.lines(), "trafo[0].param[5] 7777777", "wz[3].kinematic.param[5] -10000", "wz[3].laenge 500000"]
    chain = machine("\n".join(lines), overlay=Overlay(tool={"number": 3.0})).chain()
    assert codes(chain) == ["CB450"]
    assert pose(chain, [0] * 5)[:3, 3] == pytest.approx([0, 0, -250 - 1 - 50])


@pytest.mark.parametrize("k", [0, 2])
def test_a_direction_in_slots_is_told_at_its_slot(k: int) -> None:
    """PARAM[7] is the type of axis 0, [8] to [10] its direction, and each axis takes seven of them."""
    axes = [replace(axis, orientation=tuple(2 * v for v in axis.orientation)) if n == k else axis
            for n, axis in enumerate(CA_HEAD.axes)]  # fmt: skip
    chain = machine("\n".join(replace(CA_HEAD, axes=axes).slots())).chain()
    (told,) = [finding for finding in chain.findings if finding.code == "CB453"]
    assert told.span is not None
    assert told.span.text.startswith(f"trafo[0].param[{8 + 7 * k}] ")


def test_tools_are_added_to_slots() -> None:
    lines = [*CA_HEAD.slots(), "wz[3].kinematic.param[5] -10000"]
    chain = machine("\n".join(lines), overlay=Overlay(tool={"number": 3.0})).chain()
    assert pose(chain, [0] * 5)[:3, 3] == pytest.approx([0, 0, -250 - 1])


def test_it_equals_58_and_9() -> None:
    # 58: A 500 below the machine zero, C 60 above A. 91 counts from the machine, 58 from the workpiece at zero.
    table = Universal(
        [X, Y, Z, AxisOf91(2, (-1, 0, 0), (0, 0, -500)), AxisOf91(2, (0, 0, -1), (5, 7, -440))],
        [4, 3, 0, 1, 2],
        (0, 0, 1),
        (0, 0, -150),
    )
    of_58 = chain_of(
        ["trafo[0].id 58", "trafo[0].param[0] 1500000", "trafo[0].param[8] -5000000", "trafo[0].param[5] 600000",
         "trafo[0].param[3] 50000", "trafo[0].param[4] 70000"]
    )  # fmt: skip
    of_9 = chain_of(["trafo[0].id 9", "trafo[0].param[0] 1500000", "trafo[0].param[1] 1000000"])
    head = chain_of(CA_HEAD.lines())
    universal, rng = chain_of(table.lines()), np.random.default_rng(3)
    for _ in range(50):
        axes = rng.uniform(-200, 200, 5)
        assert np.abs(pose(universal, axes) - shift((5, 7, -440)) @ pose(of_58, axes)).max() < 1e-10
        assert np.abs(pose(head, axes) - pose(of_9, axes)).max() < 1e-10


def test_axis_names_follow_the_directions() -> None:
    names = lambda universal: [axis.name for axis in chain_of(universal.lines()).axes]  # noqa: E731
    assert names(CA_HEAD) == ["X", "Y", "Z", "C", "A"]
    turned = Universal(
        [Y, Z, X, AxisOf91(2, (0, -0.9, 0.1)), AxisOf91(2, (0, 1, 0)), AxisOf91(2, (0, 0, 1))], [0, 1, 2, 3, 4, 5]
    )
    assert names(turned) == ["Y", "Z", "X", "B1", "B2", "C"]


def linked() -> Universal:
    rows = [[0.5, 0.5, 0.0, 112.0], [0.0, 0.0, 1.0, 0.0], [0.71, -0.71, 0.0, -75.0]]
    more = ["linkage_mode 1", "programming_mode 12"]
    for i, row in enumerate(rows):
        more += [f"linkage[{i}][{j}] {value * (1e4 if j == 3 else 1)!r}" for j, value in enumerate(row)]
    return Universal([X, Y, Z, AxisOf91(2, (0, 0, 1), (10, 20, 30))], [3, 0, 1, 2], more=more)


def test_linkage_turns_axis_values_into_cartesian_ones() -> None:
    # Two parallel slides that lift what is between them: the half sum is X, the difference lifts Z.
    chain, plain = chain_of(linked().lines()), replace(linked(), more=())
    rng = np.random.default_rng(2)
    for _ in range(20):
        a, b, c, turn = rng.uniform(-100, 100, 4)
        x, y, z = 0.5 * (a + b) + 112, c, 0.71 * (a - b) - 75
        assert pose(chain, [a, b, c, turn])[:3, 3] == pytest.approx(plain.tip([x, y, z, turn])[0], abs=1e-9)
    robot = Robot(chain)
    axes = [10.0, 20.0, 30.0, 40.0]
    assert robot.axes_from_q(robot.q(axes)) == pytest.approx(axes)


def test_length_of_a_linear_direction() -> None:
    universal = Universal([AxisOf91(1, (2, 0, 0)), Y, Z], [0, 1, 2])
    scaled = chain_of(universal.lines())
    unit = chain_of(universal.lines(), conventions={"kin91_linear_length": "unit"})
    assert pose(scaled, [10, 0, 0])[0, 3] == pytest.approx(20)
    assert pose(unit, [10, 0, 0])[0, 3] == pytest.approx(10)
    assert codes(scaled) == codes(unit) == ["CB453"]
    assert [used.convention.name for used in scaled.conventions] == ["kin91_linear_length"]


@pytest.mark.parametrize(
    ("vector", "choice", "x_column"),
    [
        ((0, 0, 3), "shortest_turn", (1, 0, 0)),
        ((0, 0, -1), "shortest_turn", (1, 0, 0)),
        ((1, 1, 0), "shortest_turn", (0.5, -0.5, -np.sqrt(0.5))),
        ((1, 1, 0), "x_in_zx_plane", (0, 0, -1)),
        ((0, 1, 0), "x_in_zx_plane", (1, 0, 0)),
        ((0, -1, 0), "x_in_zx_plane", (1, 0, 0)),
        ((1, 2, 2), "x_in_zx_plane", (2 / np.sqrt(5), 0, -1 / np.sqrt(5))),
        ((0, 1e-9, 1), "shortest_turn", (1, 0, 0)),
    ],
)
def test_the_tool_frame_about_the_tool_vector(
    vector: tuple[float, ...], choice: str, x_column: tuple[float, ...]
) -> None:
    chain = chain_of(replace(CA_HEAD, zero_orientation=vector).lines(), conventions={"kin91_tool_frame": choice})
    T = pose(chain, [0] * 5)
    assert T[:3, 0] == pytest.approx(x_column, abs=1e-8)
    assert T[:3, 2] == pytest.approx(np.array(vector) / np.linalg.norm(vector))
    assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)


def test_a_table_among_others_is_a_serial_chain_of_its_own() -> None:
    T = rotation((0, 0, 1), -30) @ rotation((1, 0, 0), -20)
    assert TABLE.product([20, 30]) == pytest.approx(T)


def edited(*changes: str, universal: Universal = CA_HEAD) -> list[str]:
    """Return the list with lines replaced: NAME VALUE; a name without value is taken out."""
    lines = universal.lines()
    for change in changes:
        name, _, value = change.partition(" ")
        lines = [line for line in lines if not line.startswith(f"trafo[0].{name} ")]
        if value:
            lines.append(f"trafo[0].{change}")
    return lines


REFUSED = [
    ("number_of_axes 7", "number_of_axes is 7", "trafo[0].number_of_axes", "1, 2, 3, 4, 5, 6"),
    ("number_of_axes 0", "number_of_axes is 0", "trafo[0].number_of_axes", "1, 2, 3, 4, 5, 6"),
    ("number_of_axes 4.5", "number_of_axes is 4.5", "trafo[0].number_of_axes", "1, 2, 3, 4, 5, 6"),
    ("axis[3].type 3", "axis[3].type is 3", "trafo[0].axis[3].type", "1, 2"),
    ("axis[1].type 2", "axis 1 is rotary", "trafo[0].axis[1].type", "three linear axes at 0 to 2"),
    ("axis[3].type 1", "axis 3 is linear", "trafo[0].axis[3].type", "three linear axes at 0 to 2"),
    ("axis[4].orientation[0] 0", "the orientation of axis 4 is the zero vector", "axis[4].orientation", "any other"),
    ("zero_orientation[2] 0", "zero_orientation is the zero vector", "trafo[0].zero_orientation", "any other"),
    ("chain[4] 3", "chain[] is 0, 1, 2, 3, 3", "trafo[0].chain", "each of 0 to 4 once"),
    ("chain[4]", "chain[] is 0, 1, 2, 3, 0", "trafo[0].chain", "each of 0 to 4 once"),
    ("chain[4] 9", "chain[4] is 9", "trafo[0].chain[4]", "0 to 5"),
    ("programming_mode 11", "mode 11 is not supported", "trafo[0].programming_mode", "10, 12 to 21"),
    ("programming_mode 9", "programming_mode is 9", "trafo[0].programming_mode", "10"),
    ("rtcp 2", "rtcp is 2", "trafo[0].rtcp", "0, 1"),
    ("linkage_mode 2", "linkage_mode is 2", "trafo[0].linkage_mode", "0, 1"),
]


@pytest.mark.parametrize(("change", "text", "parameter", "permitted"), REFUSED, ids=[row[0] for row in REFUSED])
def test_refused(change: str, text: str, parameter: str, permitted: str) -> None:
    lines = edited(change)
    with pytest.raises(ChainbuildError) as caught:
        chain_of(lines)
    message = str(caught.value)
    assert text in message
    assert parameter in message
    assert permitted in message
    line = caught.value.line
    assert line is not None
    name = parameter.removeprefix("trafo[0].")
    assert lines[line - 1].startswith(f"trafo[0].{name.partition('[')[0]}") or "]" not in change


def test_a_singular_linkage() -> None:
    lines = [line.replace("linkage[1][2] 1.0", "linkage[1][2] 0.0") for line in linked().lines()]
    with pytest.raises(MachineDataError, match="singular") as caught:
        chain_of(lines)
    assert caught.value.alarm == 292010
    assert "linkage" in lines[caught.value.line - 1]


def test_three_rotary_axes_need_rtcp() -> None:
    universal = random_universal(np.random.default_rng(0), 6)
    with pytest.raises(MachineDataError, match="3 rotary axes in a complete") as caught:
        chain_of(replace(universal, rtcp=0).lines())
    assert caught.value.permitted == "at most 2"
    chain_of(replace(CA_HEAD, rtcp=0).lines())


@pytest.mark.parametrize("mode", [10, *range(12, 22)])
def test_modes_of_91_do_not_change_the_pose(mode: int) -> None:
    by_name = chain_of(edited(f"programming_mode {mode}"))
    by_channel = chain_of([*CA_HEAD.lines(), f"ori_rotation_angle {mode}"])
    assert codes(by_name) == codes(by_channel) == []
    axes = [1, 2, 3, 40, 50]
    assert np.array_equal(pose(by_name, axes), pose(by_channel, axes))


def test_what_is_left_alone_leaves_a_finding() -> None:
    lines = [*CA_HEAD.lines(), "trafo[0].inkage[2][2] 0", "trafo[0].axis[5].type 2"]
    assert codes(chain_of(lines)) == ["CB450", "CB450"]
    unordered = [line for line in CA_HEAD.lines() if ".chain[" not in line]
    chain = chain_of(unordered)
    assert codes(chain) == ["CB451"]
    assert pose(chain, [1, 2, 3, 4, 5]) == pytest.approx(pose(chain_of(CA_HEAD.lines()), [1, 2, 3, 4, 5]))


def test_parameters_are_explained() -> None:
    rows = {row.name: row for row in machine("\n".join(linked().lines())).parameters()}
    assert (rows["trafo[0].axis[3].point[1]"].value, rows["trafo[0].axis[3].point[1]"].unit) == (20, "mm")
    assert rows["trafo[0].linkage[0][3]"].source == "P-CHAN-00295"
    slots = {row.symbol: row for row in machine("\n".join(CA_HEAD.slots())).parameters()}
    assert (slots["HD6"].value, slots["HD6"].unit) == (-250, "mm")
    assert slots["HD42"].meaning.startswith("axis[4].point[2]: A point on a rotary axis")
