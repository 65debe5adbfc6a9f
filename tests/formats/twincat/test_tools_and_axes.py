"""Tool lists, and axis lists that the overlay names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.lists.toollist import read_tools
from tests.kit.twincat_files import codes, kin_45, machine, parameters, pose

TOOLS = """\
wz[5].laenge            6000        # Tool length
wz[5].radius            54000
wz[5].gueltig           1
wz[5].mass_einheit      0
wz[5].ax_versatz[0]     205000
wz[5].kinematic.param[0] 1538000    # 153.8 mm
wz[5].kin_name ROBOT
wz[8].kinematic.wz_kopf_versatz[1] 25000
wz[8].wz_kopf_versatz[2] 7
wz[8].kin_id 6
"""


def test_tool_list() -> None:
    tools = read_tools(parameters(TOOLS), Collector())
    assert (tools[5].length_mm, tools[5].radius_mm, tools[5].kin_name) == (0.6, 5.4, "ROBOT")
    assert {j: entry.value for j, entry in tools[5].params.items()} == {0: 1538000}
    assert {j: entry.value for j, entry in tools[8].params.items()} == {1: 25000, 2: 7}
    assert (tools[8].kin_id, tools[8].length_mm) == (6, 0)


def test_large_tool_numbers() -> None:
    assert read_tools(parameters("wz[65535].laenge 10000"), Collector())[65535].length_mm == 1


def test_an_active_tool_adds_to_the_channel_parameters() -> None:
    text = kin_45({1: 100000, 2: 200000, 34: 4}, "wz[1].kinematic.param[0] 50000\nwz[1].laenge 30000\nwz[2].laenge 1")
    bare = pose(machine(text).chain(), [0] * 6)
    tool = pose(machine(text, overlay=Overlay(tool={"number": 1.0})).chain(), [0] * 6)
    # At zero the flange's z is the base's x: 5 mm of HD1 and 3 mm of length.
    np.testing.assert_allclose(tool[:3, 3] - bare[:3, 3], [8, 0, 0], atol=1e-12)


def test_lengths_add_up() -> None:
    text = kin_45({34: 4}, "wz[1].laenge 10000")
    overlay = Overlay(tool={"number": 1.0}, tool_length_mm=20)
    assert pose(machine(text, overlay=overlay).chain(tool_length_mm=400), [0] * 6)[0, 3] == pytest.approx(421)


def test_a_tool_of_another_kinematic_is_not_added() -> None:
    text = kin_45({1: 100000}, "trafo[0].name A\nwz[1].kinematic.param[0] 50000\nwz[1].kin_name B")
    chain = machine(text, overlay=Overlay(tool={"number": 1.0})).chain()
    assert "CB243" in codes(chain)
    assert pose(chain, [0] * 6)[0, 3] == pytest.approx(10)


def test_tool_parameters_act_in_the_first_step_only() -> None:
    text = "kin_step[1].trafo[0].id 45\nwz[1].kinematic.param[0] 50000"
    chain = machine(text, overlay=Overlay(tool={"number": 1.0})).chain(45)
    assert "CB242" in codes(chain)
    assert pose(chain, [0] * 6)[0, 3] == 0


def test_a_tool_meant_for_another_id() -> None:
    chain = machine(kin_45({}, "wz[1].kin_id 6"), overlay=Overlay(tool={"number": 1.0})).chain()
    assert "CB244" in codes(chain)


def test_an_axis_list_named_by_the_overlay(tmp_path: Path) -> None:
    files = []
    for i in range(6):
        files.append(tmp_path / f"achsmds{i}.lis")
        files[-1].write_text(
            f"kopf.achs_nr {i}\nkenngr.swe_neg -{i + 1}0000 ( P-AXIS-00177\nkenngr.swe_pos {i + 1}5000\nEnde"
        )
    chain = machine(kin_45({}), overlay=Overlay(axis_lists=tuple(files))).chain()
    assert [(a.lower, a.upper) for a in chain.axes] == [(-i, i + 0.5) for i in range(1, 7)]
    files[0].write_text("kopf.achs_nr 1")
    assert "CB231" in codes(machine(kin_45({}), overlay=Overlay(axis_lists=(files[0],))))


def test_the_limits_of_the_overlay_win(tmp_path: Path) -> None:
    file = tmp_path / "a.lis"
    file.write_text("kopf.log_achs_name C1\nkenngr.swe_neg -10000\nkenngr.swe_pos 10000")
    axes = machine(kin_45({}), overlay=Overlay(axis_lists=(file,), limits={"C1": (-170.0, 170.0)})).chain().axes
    assert (axes[0].lower, axes[0].upper, axes[0].assumed) == (-170, 170, False)
    assert axes[1].assumed
