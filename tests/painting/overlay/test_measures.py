"""Lengths of machine data as lines: what they place, and where it would be without them, by another chain."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import chainbuild
from chainbuild import Dimension, Machine, MachineDataError
from chainbuild.chain.elements import Chain

MACHINES = ("kr6r900", "irb2600_table", "ac_table_kin58", "ba_head_c_table_kin82", "ca_head_kin9", "delta_kin37")


@cache
def loaded(name: str) -> Machine:
    return chainbuild.load(name)


def place_of(chain: Chain, one: Dimension) -> np.ndarray:
    """Return where what a length places is in its link."""
    for joint in chain.joints:
        if joint.name == one.places and joint.parent == one.link:
            return np.asarray(joint.T_parent_joint[:3, 3])
    return np.asarray(chain.frame(one.places).T_link_frame[:3, 3])


@pytest.mark.parametrize("name", MACHINES)
def test_lines_end_where_the_thing_is_and_begin_where_it_would_be(name: str) -> None:
    machine = loaded(name)
    found = chainbuild.dimensions(machine)
    assert found
    for one in found:
        assert place_of(machine.chain(), one) == pytest.approx(one.end, abs=1e-12)
        without = machine.with_values({one.datum: 0.0}).trial_chain()
        assert place_of(without, one) == pytest.approx(one.start, abs=1e-9), one.label
        assert np.linalg.norm(one.end - one.start) > 0.0


def test_lines_of_an_arm_are_those_of_its_drawing() -> None:
    found = {one.datum.name: one for one in chainbuild.dimensions(loaded("kr6r900"))}
    assert [(one.label, one.places) for one in found.values()] == [
        ("MAIN_LENGTH_AB[0] = 25 mm", "A2"), ("MAIN_LENGTH_AB[1] = 455 mm", "A3"), ("TX3P3_POS[0] = 420 mm", "A4"),
        ("TX3P3_POS[2] = 35 mm", "A4"), ("TFLWP_POS[2] = 80 mm", "flange"), ("TIRORO_POS[2] = 400 mm", "A1"),
    ]  # fmt: skip
    first = found["$MC_ROBX_TIRORO_POS[2]"]
    assert first.link == "base"
    assert first.start.tolist() == pytest.approx([0.0, 0.0, 0.0])
    assert first.end.tolist() == pytest.approx([0.0, 0.0, 0.4])


def test_names_are_short_where_they_are_the_only_ones() -> None:
    labels = [one.label for one in chainbuild.dimensions(loaded("ac_table_kin58"))]
    assert labels == ["HD1 = 150 mm", "HD6 = −60 mm", "HD9 = −500 mm"]
    # Two steps, each with an HD7: both by their names in the file; the second step's data alone by their own.
    labels = [one.label for one in chainbuild.dimensions(loaded("robot_tilting_table_kin210"))]
    assert len(set(labels)) == len(labels)


def test_a_selection_is_as_for_chain() -> None:
    found = chainbuild.dimensions(loaded("ca_head_kin9"), tool_length_mm=55.0)
    assert "tool_length = 55 mm" in [one.label for one in found]
    with pytest.raises(MachineDataError):
        chainbuild.dimensions(loaded("kr6r900"), "nothing")
