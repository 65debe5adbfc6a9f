"""Recordings of which the chain completes the poses: every chain that is tried completes them by itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.comparison.convention_trials import try_conventions
from chainbuild.comparison.data_trials import try_data
from chainbuild.comparison.evidence import Evidence
from chainbuild.comparison.samples import make_samples
from chainbuild.formats.machine import Machine

POSITION = ("x_mm", "y_mm", "z_mm")
TOLERANCE = (1e-5, 1e-4)


def record(path: Path, there: chainbuild.Chain, here: chainbuild.Chain, count: int = 8) -> chainbuild.Recording:
    """Write what a controller with one model displays; return how a machine with another model reads it."""
    robot = chainbuild.Robot(there)
    rows = make_samples(chainbuild.Robot(here), count, ("random",)).axes
    columns = (*POSITION, *here.display_columns)
    lines = [",".join((*(axis.name for axis in here.axes), *columns))]
    for row in rows:
        shown = dict(zip(POSITION, (robot.fk(row).translation * 1e3).tolist(), strict=True)) | robot.display(row)
        lines.append(",".join(map(repr, [*row.tolist(), *(float(shown[name]) for name in columns)])))
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return chainbuild.read_recording(path, here)


def evidence(recording: chainbuild.Recording) -> Evidence:
    return Evidence(recording.axes, recording.poses, recording.compared, TOLERANCE, recording)


def chains(machine: Machine, **choices: str) -> tuple[chainbuild.Chain, chainbuild.Chain]:
    return machine.chain(), machine.chain(conventions=choices)


def test_a_recording_is_read_once(tmp_path: Path) -> None:
    here, there = chains(chainbuild.load("palletiser_kin213"), kin213_angles="pitch_and_turn")
    recording = record(tmp_path / "r.csv", there, here)
    meant = chainbuild.read_recording(tmp_path / "r.csv", there).poses
    (tmp_path / "r.csv").unlink()
    assert np.abs(recording.read_for(there) - meant).max() == 0.0
    assert np.abs(recording.read_for(there, rows=np.array([5, 2])) - meant[[5, 2]]).max() == 0.0
    assert np.abs(recording.poses - meant).max() > 1e-3
    np.testing.assert_array_equal(recording.read_for(here), recording.poses)
    some = replace(recording, axes=recording.axes[3:], poses=recording.poses[3:])
    np.testing.assert_array_equal(some.read_for(there), some.poses)  # the rows of the file are others


def test_a_chain_that_shows_other_columns_is_refused(tmp_path: Path) -> None:
    there, here = chains(chainbuild.load("scara_kin36"), kin36_c="absolute")
    recording = record(tmp_path / "r.csv", here, here)
    with pytest.raises(chainbuild.ChainbuildError, match="unknown column c_deg"):
        recording.read_for(there)


@pytest.mark.parametrize(
    ("name", "symbol", "value"),
    [
        ("palletiser_kin213", "HD6", 7.0),
        ("palletiser_kin213", "HD14", -83.0),
        ("cyl_2rot_kin202", "HD10", 1.0),
        ("palletiser_nr4", "$MC_ROBX_TX3P3_RPY[0]", 7.0),
    ],
)
def test_a_wrong_datum_is_named_from_part_of_the_angles(tmp_path: Path, name: str, symbol: str, value: float) -> None:
    machine = chainbuild.load(name)
    one = next(one for one in machine.geometry() if symbol in (one.name, one.symbol))
    recording = record(tmp_path / "r.csv", machine.with_values({one: value}).trial_chain(), machine.chain())
    found = try_data(machine, chainbuild.Selection(), {}, evidence(recording))
    assert {one.name: value} in [{d.name: v for d, v in trial.values.items()} for trial in found if trial.agrees]


def test_the_progress_of_conventions_is_told(tmp_path: Path) -> None:
    machine = chainbuild.load("palletiser_kin213")
    here, there = chains(machine, kin213_angles="pitch_and_turn")
    told: list[tuple[int, int]] = []
    found = try_conventions(
        machine, chainbuild.Selection(), {}, evidence(record(tmp_path / "r.csv", there, here)),
        lambda done, total: told.append((done, total)),
    )  # fmt: skip
    assert [dict(trial.choices) for trial in found if trial.agrees] == [{"kin213_angles": "pitch_and_turn"}]
    assert told == [(n, len(found)) for n in range(1, len(found) + 1)]


@pytest.mark.parametrize(
    ("columns", "row", "text"),
    [
        ("qx,qy,qz,qw", "0,0,0,0.5", r"\(qx, qy, qz, qw\) has the length 0.5"),
        ("tool_x,tool_y,tool_z", "0,0,2", r"\(tool_x, tool_y, tool_z\) has the length 2"),
    ],
)
def test_a_vector_of_another_length_is_refused_with_its_line(tmp_path: Path, columns: str, row: str, text: str) -> None:
    path = tmp_path / "r.csv"
    unit = ",".join(["0"] * columns.count(",") + ["1"])
    lines = [f"A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm,{columns}", *(f"0,-90,90,0,30,0,514,0,850,{v}" for v in (unit, row))]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    with pytest.raises(chainbuild.ChainbuildError, match=f"r.csv:3: {text}"):
        chainbuild.read_recording(path, chainbuild.load("kr6r900").chain())
