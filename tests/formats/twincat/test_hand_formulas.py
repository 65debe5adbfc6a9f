"""Every KIN_TYP against a formula written by hand from the manual, by somebody who had not seen the recipe.

The machine goes the whole way: a channel list as text, reader, catalogue, recipe, chain, Pinocchio. Full poses are
compared, all parameters non-zero, directions reversed at random, every choice of every convention that applies.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.convention import conventions
from chainbuild.errors import ChainbuildError
from chainbuild.formats.twincat.maps.heads import VirtualTurnMap
from tests.hand.kin_heads import FORMULAS as HEADS
from tests.hand.loops_hand import LOOPS
from tests.kit.draws import seed_of
from tests.kit.random_types import FORMULAS, channel_list, random_axes, random_machine
from tests.kit.straight import check_joint_values

POSITION_MM = 1e-6
ROTATION = 1e-9

MACHINES = 20
VECTORS = 100  # MACHINES × VECTORS = 2,000 poses a type
CHOICE_MACHINES = 3
CHOICE_VECTORS = 10


def compare(kin: int, folder: Path, rng: np.random.Generator, vectors: int, conv: dict[str, str]) -> int:
    """Compare one random machine; return how many poses agreed (poses that both refuse do not count)."""
    param = random_machine(kin, rng)
    length = float(rng.uniform(10.0, 200.0))
    path = folder / f"kin{kin}.lis"
    path.write_text(channel_list(kin, param))
    robot = chainbuild.Robot(chainbuild.load(path).chain(tool_length_mm=length, conventions=conv))
    check_joint_values(robot.chain, {"level": "G3", "plane": "Z", "plunge": "Z"})
    agreed = 0
    for _ in range(vectors):
        axes = random_axes(kin, rng)
        try:
            wanted = FORMULAS[kin](param, axes, length, conv)
        except ValueError:
            with pytest.raises(ChainbuildError):
                robot.fk(axes)
            continue
        T = robot.fk(axes)
        where = f"KIN_TYP {kin}, {conv}, param {param}, L {length}, axes {axes}"
        np.testing.assert_allclose(T.translation * 1000.0, wanted[:3, 3], atol=POSITION_MM, rtol=0, err_msg=where)
        np.testing.assert_allclose(T.rotation, wanted[:3, :3], atol=ROTATION, rtol=0, err_msg=where)
        agreed += 1
    return agreed


def test_every_built_type_has_a_formula() -> None:
    table = {19}  # tests.hand.loops_table: its state has no formula but equations, compared in test_rod_table.py
    assert set(chainbuild.catalogue()) <= set(FORMULAS) | set(LOOPS) | table | {91, 98, 210}


@pytest.mark.parametrize("kin", sorted(FORMULAS))
def test_type_follows_its_hand_formula(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of(kin))
    agreed = sum(compare(kin, tmp_path, rng, VECTORS, {}) for _ in range(MACHINES))
    assert agreed >= 0.9 * MACHINES * VECTORS


@pytest.mark.parametrize("kin", sorted(FORMULAS))
def test_axes_are_reversed_and_off_zero_where_they_can_be(kin: int, tmp_path: Path) -> None:
    """The machines drawn above count either way about every axis with a direction, and from other zeros."""
    rng, data = np.random.default_rng(seed_of(kin)), chainbuild.catalogue()[kin]
    senses: dict[str, set[bool]] = {}
    off_zero: set[str] = set()
    for _ in range(MACHINES):
        path = tmp_path / f"kin{kin}.lis"
        path.write_text(channel_list(kin, random_machine(kin, rng)))
        chain = chainbuild.load(path).chain()
        bent = chain.axis_map.straight if isinstance(chain.axis_map, VirtualTurnMap) else None
        for n, joint in enumerate(chain.joints):
            backwards = joint.reversed if bent is None else bent.A[n, n] < 0.0
            senses.setdefault(joint.name, set()).add(backwards)
            if joint.zero or (bent is not None and bent.b[n]):
                off_zero.add(joint.name)
    named = {joint.upper(): joint for joint in senses}
    for row in data.hd:
        joint = named.get(row.name.rsplit("_", 1)[-1].upper())
        if joint is not None and row.name.startswith("direction_"):
            assert senses[joint] == {True, False}, f"{joint} is never reversed, or always"
        if joint is not None and row.kind == "angle" and "offset_" in row.name:
            assert joint in off_zero, f"{joint} always counts from the zero drawn"


CHOICES = [
    (kin, name, choice)
    for name, convention in sorted(conventions().items())
    for choice in convention.choices
    for kin in sorted(FORMULAS)
    if f"KIN {kin}" in convention.applies
]


@pytest.mark.parametrize(("kin", "name", "choice"), CHOICES)
def test_every_choice_follows_its_hand_formula(kin: int, name: str, choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of(kin, name, choice))
    agreed = sum(compare(kin, tmp_path, rng, CHOICE_VECTORS, {name: choice}) for _ in range(CHOICE_MACHINES))
    assert agreed >= 0.5 * CHOICE_MACHINES * CHOICE_VECTORS


SAW_CHOICES = [("kin59_saw_tcp", c) for c in conventions()["kin59_saw_tcp"].choices]
SAW_CHOICES += [("kin59_saw_angle", c) for c in conventions()["kin59_saw_angle"].choices]
SAW_CHOICES += [("kin59_underfloor", c) for c in conventions()["kin59_underfloor"].choices]


@pytest.mark.parametrize("option", [1, 2])  # HD20: 1 underfloor cutter, 2 saw blade
@pytest.mark.parametrize(("name", "choice"), SAW_CHOICES)
def test_saw_blade_and_underfloor_cutter_of_59(option: int, name: str, choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of(59, option, name, choice))
    for _ in range(10):
        param = random_machine(59, rng)
        param[19] = float(option)
        param[18] = float(rng.integers(-300_000, 300_000))
        radius = float(rng.integers(50, 200))
        tool = f"wz[1].nr 1\nwz[1].radius {radius * 1e4:.0f}\nwz[1].kinematic.param[0] 250000\nEnde\n"
        path = tmp_path / "saw.lis"
        path.write_text(channel_list(59, param).replace("Ende\n", tool))
        (tmp_path / "saw.chainbuild.toml").write_text("[tool]\nnumber = 1\n")
        robot = chainbuild.Robot(chainbuild.load(path).chain(conventions={name: choice}))
        added = {**param, 0: param[0] + 250_000.0}  # tool offsets are added to the channel's
        for _ in range(10):
            axes = random_axes(59, rng)
            wanted = HEADS[59](added, axes, 0.0, {name: choice}, blade_radius_mm=radius)
            T = robot.fk(axes)
            np.testing.assert_allclose(T.translation * 1000.0, wanted[:3, 3], atol=POSITION_MM, rtol=0)
            np.testing.assert_allclose(T.rotation, wanted[:3, :3], atol=ROTATION, rtol=0)
