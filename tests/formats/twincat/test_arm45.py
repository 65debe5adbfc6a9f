"""KIN_TYP 45 against published arms, and every convention by what its meaning says."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.elements import Chain
from chainbuild.errors import ChainbuildError
from chainbuild.frames import inverse, rot_x, rot_y, rot_z, transform, translation
from tests.kit.paths import REFERENCE
from tests.kit.twincat_files import codes, kin_45, machine, pose

# Plausible, all lengths different, every offset set, joints 2, 4 and 6 reversed.
FULL = {
    1: 1100000, 2: 210000, 3: -320000, 4: 150000, 5: -250000, 6: 400000, 7: 4000000, 8: 4550000, 9: 4200000, 10: 900000,
    11: 250000, 12: -350000, 14: -900000, 15: 800000, 22: 1, 24: 1, 26: 1, 32: 170000, 36: 50000, 37: -110000,
    38: 70000, 39: 130000,
}  # fmt: skip
AXES = [11.0, -35.0, 62.0, -48.0, 27.0, 141.0]


def arm(hd: dict[int, float], length: float = 0.0, **conventions: str) -> Chain:
    return machine(kin_45(hd)).chain(tool_length_mm=length, conventions=conventions)


def asked(chain: Chain) -> list[str]:
    """Return the conventions that shaped the geometry; which axis #ORI MODE points is asked of every arm."""
    return [used.convention.name for used in chain.conventions if used.convention.name != "ori_vector_axis"]


def same(a: np.ndarray, b: np.ndarray) -> None:
    np.testing.assert_allclose(a, b, atol=1e-9)


@pytest.mark.parametrize("name", ["kin45_kr6r900_2", "kin45_tx2_60"])
def test_published_arms(name: str) -> None:
    truth: dict[str, Any] = json.loads((REFERENCE / f"{name}.json").read_text("utf-8"))
    chain = chainbuild.load(REFERENCE / f"{name}.lis").chain(tool_length_mm=truth["tool_length"])
    for row in truth["rows"]:
        T = pose(chain, row["axes"])
        assert np.abs(T[:3, 3] - row["p"]).max() <= 1e-6
        assert np.abs(T[:3, :3] - np.array(row["R"])).max() <= 1e-9


def test_names_and_frames() -> None:
    chain = arm(FULL)
    assert [joint.name for joint in chain.joints] == ["C1", "B1", "B2", "A1", "B3", "A2"]
    assert [axis.name for axis in chain.axes] == ["C1", "B1", "B2", "A1", "B3", "A2"]
    assert {frame.name for frame in chain.frames} == {"base", "flange", "tool", "workpiece"}
    assert (chain.kinematic, chain.dialect) == ("KIN_TYP 45", "TwinCAT CNC")


def test_zero_position() -> None:
    # Upper arm up, forearm and hand along +X; z out of the flange, x down.
    T = pose(arm({7: 4000000, 8: 4550000, 9: 4200000, 10: 900000, 11: 250000, 12: 350000, 32: 170000}), [0] * 6)
    same(T[:3, 3], np.array([25 + 420 + 90, -17, 400 + 455 - 35]))
    same(T[:3, :3], rot_y(90))


def test_offsets_make_the_axis_zero_a_straight_horizontal_arm() -> None:
    T = pose(arm({7: 4000000, 8: 4550000, 9: 4200000, 10: 900000, 14: -900000, 15: 900000}), [0] * 6)
    same(T[:3, 3], np.array([455 + 420 + 90, 0, 400]))


@pytest.mark.parametrize(
    ("order", "rotation"),
    [(0, rot_z(40) @ rot_y(-25) @ rot_x(15)), (1, rot_x(15) @ rot_y(-25) @ rot_z(40))],
)
def test_tool_rotation_order(order: int, rotation: np.ndarray) -> None:
    same(pose(arm({4: 150000, 5: -250000, 6: 400000, 35: order}), [0] * 6)[:3, :3], rot_y(90) @ rotation)


def test_tool_offsets_count_in_the_flange_frame() -> None:
    T = pose(arm({1: 10000, 2: 20000, 3: 30000}), [0] * 6)
    same(T[:3, 3], np.array([1, 3, -2]))  # z is the base's x, x its -z


@pytest.mark.parametrize(
    ("direction", "moved"),
    [(1, (0, 0, -5)), (2, (-5, 0, 0)), (3, (0, -5, 0)), (4, (0, 0, 5)), (5, (5, 0, 0)), (6, (0, 5, 0))],
)
def test_direction_of_the_tool_length(direction: int, moved: tuple[float, float, float]) -> None:
    bare, long = (pose(arm(FULL | {34: direction}, length), AXES) for length in (0.0, 5.0))
    same(inverse(bare) @ long, translation(*moved))


def test_a_tool_length_without_direction_is_ignored() -> None:
    chain = arm(FULL, 5.0)
    assert codes(chain) == ["CB407"]
    same(pose(chain, AXES), pose(arm(FULL), AXES))


def test_negative_lengths_are_possible() -> None:
    same(inverse(pose(arm({34: 4}), AXES)) @ pose(arm({34: 4}, -5.0), AXES), translation(z=-5))


def test_moving_workpiece() -> None:
    """The flange carries the workpiece; HD1 to HD6 place the tool in the base frame."""
    flange = pose(arm({n: value for n, value in FULL.items() if n > 6}), AXES)
    tool = transform(rot_z(40) @ rot_y(-25) @ rot_x(15), (21, -32, 110))
    chain = arm(FULL | {33: 1})
    same(pose(chain, AXES), inverse(flange) @ tool)
    assert {axis.carries for axis in chain.axes} == {"workpiece"}
    same(pose(arm(FULL | {33: 1, 34: 4}, 7.0), AXES), inverse(flange) @ tool @ translation(z=7))


@pytest.mark.parametrize("joint", range(6))
def test_each_direction_flag_reverses_its_joint(joint: int) -> None:
    plain = {n: FULL[n] for n in (7, 8, 9, 10, 11, 12, 32)}
    mirrored = list(AXES)
    mirrored[joint] = -mirrored[joint]
    same(pose(arm(plain | {21 + joint: 1}), AXES), pose(arm(plain), mirrored))


@pytest.mark.parametrize(("joint", "hd"), list(enumerate([36, 14, 15, 37, 38, 39])))
def test_each_zero_offset_is_taken_off_its_joint(joint: int, hd: int) -> None:
    plain = {n: FULL[n] for n in (7, 8, 9, 10, 11, 12, 32)}
    shifted = list(AXES)
    shifted[joint] -= 12.5
    same(pose(arm(plain | {hd: 125000}), AXES), pose(arm(plain), shifted))


@pytest.mark.parametrize("hd", sorted({*FULL, 31, 33, 35}))
def test_every_head_offset_has_an_effect(hd: int) -> None:
    changed = 1 - FULL.get(hd, 0) if hd in (22, 24, 26, 31, 33, 35) else FULL.get(hd, 0) + 10000
    assert np.abs(pose(arm(FULL | {hd: changed}), AXES) - pose(arm(FULL), AXES)).max() > 1e-3


# ---------------------------------------------------------------- conventions


@pytest.mark.parametrize(("choice", "sign"), [("as_printed", 1), ("outside", 1), ("inside", -1)])
def test_offset_inside_flag(choice: str, sign: float) -> None:
    """Joint 2 reversed with an offset of 10 degrees: -q - 10 outside, -(q - 10) inside."""
    plain = {n: FULL[n] for n in (7, 8, 9, 10, 11, 12, 32)}
    chain = arm(plain | {14: 100000, 22: 1}, offset_inside_flag=choice)
    reversed_ = list(AXES)
    reversed_[1] = -AXES[1] - sign * 10.0
    same(pose(chain, AXES), pose(arm(plain), reversed_))
    assert asked(chain) == ["offset_inside_flag"]


def test_offset_inside_flag_matters_at_reversed_axes_only() -> None:
    assert asked(arm({14: 100000})) == []
    assert asked(arm({22: 1})) == []


HAND = {7: 4000000, 10: 900000}


@pytest.mark.parametrize(
    ("choice", "turned"),
    [
        ("base_frame", lambda t, R: t @ R),
        ("z_out_x_up", lambda t, R: transform(rot_y(90) @ rot_z(180)) @ t @ R),
        ("base_frame_offsets_variant_1", lambda t, R: transform(rot_y(90)) @ t @ transform(rot_y(-90)) @ R),
    ],
)
def test_flange_variant_2(choice: str, turned: Any) -> None:
    tool = {n: FULL[n] for n in range(1, 7)}
    chain = arm(HAND | tool | {31: 1}, flange_variant_2=choice)
    R = transform(rot_z(40) @ rot_y(-25) @ rot_x(15))
    same(pose(chain, [0] * 6), translation(90, 0, 400) @ turned(translation(21, -32, 110), R))
    assert "flange_variant_2" in asked(chain)


@pytest.mark.parametrize(
    ("choice", "flange"), [("base_frame", np.eye(3)), ("z_out_x_up", rot_y(90) @ rot_z(180)),
                           ("base_frame_offsets_variant_1", np.eye(3))],
)  # fmt: skip
def test_flange_variant_2_with_moving_workpiece(choice: str, flange: np.ndarray) -> None:
    chain = arm(HAND | {1: FULL[1], 31: 1, 33: 1}, flange_variant_2=choice)
    expected = inverse(translation(90, 0, 400) @ transform(flange)) @ translation(0, 0, 110)
    same(pose(chain, [0] * 6), expected)


def test_variant_1_asks_nothing() -> None:
    assert asked(arm(HAND)) == []


@pytest.mark.parametrize(("choice", "moved"), [("tool", (0, 0, -10)), ("flange", (10, 0, 0))])
def test_kin45_length_frame(choice: str, moved: tuple[float, float, float]) -> None:
    """HD5 = 90 turns the tool's z onto the flange's x, which points down at zero."""
    hd = HAND | {5: 900000, 34: 4}
    bare, long = (pose(arm(hd, length, kin45_length_frame=choice), [0] * 6) for length in (0.0, 10.0))
    same(long[:3, 3] - bare[:3, 3], np.array(moved))


def test_kin45_length_frame_matters_with_a_turned_tool_only() -> None:
    assert asked(arm(HAND | {34: 4}, 10.0)) == []


def test_choices_that_do_not_exist() -> None:
    with pytest.raises(ChainbuildError, match=r"no choice 'top'.*permitted: base_frame"):
        arm(HAND, flange_variant_2="top")
