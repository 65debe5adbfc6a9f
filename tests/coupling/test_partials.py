"""Partials during distribution: which axes are their own, which angle is exact, where they shift to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.compose import beside, follow, stack
from chainbuild.chain.elements import Chain, Partial
from chainbuild.coupling.distribution import partial_coordinate
from chainbuild.coupling.partial_state import State
from chainbuild.frames import angles_from_matrix, matrix_from_angles, rot_z, transform

POSE = [600.0, 50.0, 700.0, 10.0, 20.0, 30.0]


def test_a_partial_beside_carries_no_workpiece(arm: Chain, scara: Chain) -> None:
    """Only a group whose own axes carry the workpiece moves what the tool counts from."""
    robot = chainbuild.Robot(beside(arm, scara, name="ARM", other_name="SCARA"))
    current = {"SCARA": [300.0, 200.0, 100.0, 0.0, 0.0, 45.0]}
    found = robot.distribute(POSE, current=current)
    assert found.partials[0].values.tolist() == pytest.approx(POSE)
    assert robot.distribute(axes={"ARM.X": 500.0}, current=current).tcp[0] == pytest.approx(500.0)


def test_a_group_that_carries_the_workpiece_moves_what_is_counted_from(arm: Chain, scara: Chain) -> None:
    robot = chainbuild.Robot(follow(arm, workpiece_of=scara, name="ARM", other_name="SCARA"))
    there = np.array([300.0, 200.0, 100.0, 0.0, 0.0, 0.0])
    found = robot.distribute(POSE, current={"SCARA": there.tolist()})
    arm_part, other = found.partials
    assert other.values[:2].tolist() == pytest.approx([300.0, 200.0])
    assert (
        pytest.approx(other.T @ transform(matrix_from_angles(arm.angle_mode, POSE[3:]), np.array(POSE[:3]) / 1e3))
        == arm_part.T
    )


def test_every_axis_of_a_stack_is_found_in_its_own_partial(arm: Chain, scara: Chain) -> None:
    chain = follow(stack(scara, np.eye(4), arm, lower_name="LOW", upper_name="UP"), workpiece_of=arm, other_name="SIDE")
    names = [axis.name for axis in chain.axes]
    found = [partial_coordinate(chain, name) for name in names if len(name) > 1]
    own = [(p.name, axis.name) for p in chain.partials for axis in p.chain.axes]
    assert found == [pair for name, pair in zip(names, own, strict=True) if len(name) > 1]
    assert len({pair[0] for pair in found}) >= 2


@pytest.mark.parametrize("before", [0.0, 300.0, -1234.5])
def test_a_shift_ends_at_the_position_wherever_it_starts(arm: Chain, before: float) -> None:
    state = State.of(Partial("ARM", arm, np.eye(4), 0))
    state.now[:3] = before
    state.shift(np.array([400.0, 500.0, 600.0]))
    assert state.now[:3].tolist() == pytest.approx([400.0, 500.0, 600.0])
    state.shift(np.array([400.0, 500.0, 600.0]))
    assert state.now[:3].tolist() == pytest.approx([400.0, 500.0, 600.0])


@pytest.mark.parametrize("angles", [(20.0, 0.0, 0.0), (180.0, 0.0, 0.0), (400.0, 0.0, 0.0), (-725.5, 12.5, -7.0)])
def test_an_angle_that_a_partial_can_reach_is_exact(scara: Chain, angles: Sequence[float]) -> None:
    """Where the angles that it cannot turn agree already, also by a whole turn, the free ones are taken as they are."""
    for turns in (0.0, 360.0, -360.0):
        state = State.of(Partial("SCARA", scara, np.eye(4), 0))
        letters = [letter for letter in "ABC" if letter in state.freedoms.letters]
        free = [3 + "ABC".index(letter) for letter in letters]
        wanted = np.zeros(3)
        for n in free:
            wanted[n - 3] = angles[0]
        held = [n for n in (3, 4, 5) if n not in free]
        state.now[held] = np.array([angles[1], angles[2]])[: len(held)] + turns
        wanted[[n - 3 for n in held]] = np.array([angles[1], angles[2]])[: len(held)]
        state.turn(matrix_from_angles(scara.angle_mode, wanted.tolist()), wanted)
        assert state.now[free].tolist() == [angles[0]] * len(free)
        assert state.now[held].tolist() == (wanted[[n - 3 for n in held]] + turns).tolist()


def test_an_angle_in_another_mode_is_taken_from_the_rotation(scara: Chain) -> None:
    state = State.of(Partial("SCARA", scara, np.eye(4), 0))
    R = matrix_from_angles(scara.angle_mode, state.now[3:].tolist()) @ rot_z(33.0)
    state.turn(R, None)
    assert state.now[3:].tolist() == list(angles_from_matrix(scara.angle_mode, R))
