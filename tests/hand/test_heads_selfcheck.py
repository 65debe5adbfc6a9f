"""Checks the hand formulas of the heads and of arm 45: conventions, parameters, rank, published poses."""

from __future__ import annotations

import json
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.paths import REFERENCE, ROOT

from .heads_cases import AXIS_COUNT, FLAGS, SILENT, pose, sample
from .kin_heads import FORMULAS
from .kin_heads_base import CHOICES, Params

CONVENTIONS = tomllib.loads((ROOT / "chainbuild" / "data" / "conventions_twincat_heads.toml").read_text("utf-8"))


def read_lis(path: Path) -> Params:
    """Returns the raw parameters of trafo[0]."""
    return {int(i): float(v) for i, v in re.findall(r"trafo\[0\]\.param\[(\d+)\]\s+(\S+)", path.read_text("utf-8"))}


# ------------------------------------------------------------------ convention table


def test_choices_equal_convention_file() -> None:
    assert {name: tuple(entry["choices"]) for name, entry in CONVENTIONS.items()} == CHOICES
    assert all(entry["default"] == CHOICES[name][0] for name, entry in CONVENTIONS.items())


SETUPS: dict[str, list[Params]] = {
    "spatial_angle_offsets": [{20: 0.0}],
    "kin59_saw_tcp": [{19: 2.0, 18: 33e4}],
    "kin59_saw_angle": [{19: 2.0, 18: 33e4}],
    "kin59_underfloor": [{19: 1.0, 18: 33e4}],
    "kin5_spindle_pairs": [{}, {4: 170e4}],
}


@pytest.mark.parametrize("name", sorted(CHOICES))
def test_every_choice_changes_exactly_the_types_it_applies_to(name: str) -> None:
    """A choice that changes no pose, or one of a type not listed, makes the table wrong."""
    listed = {int(kin.split()[1]) for kin in CONVENTIONS[name]["applies"]}
    for other in CHOICES[name][1:]:
        changed = set()
        for kin in FORMULAS:
            param, axes = sample(kin)
            for extra in SETUPS.get(name, [{}]):
                full = param | (extra if kin in listed else {})
                kwargs: dict[str, Any] = {"blade_radius_mm": 150.0} if kin == 59 else {}
                first = FORMULAS[kin](full, axes, 50.0, {}, **kwargs)
                if np.abs(FORMULAS[kin](full, axes, 50.0, {name: other}, **kwargs) - first).max() > 1e-6:
                    changed.add(kin)
        # Taking the offset off outside the flag is what the heads' own formulas print.
        printed = (name, other) == ("offset_inside_flag", "outside")
        assert changed == (set() if printed else listed & set(FORMULAS)), other


def test_unknown_choice_is_refused() -> None:
    with pytest.raises(ValueError, match="kin25_length"):
        pose(25, [0.0] * 5, 0.0, {"kin25_length": "other"})


# ------------------------------------------------------------------ every type


@pytest.mark.parametrize("kin", sorted(FORMULAS))
def test_every_parameter_and_axis_acts(kin: int) -> None:
    param, axes = sample(kin)
    first = FORMULAS[kin](param, axes, 50.0, {})
    assert np.allclose(first[:3, :3] @ first[:3, :3].T, np.eye(3), atol=1e-12)
    assert math.isclose(np.linalg.det(first[:3, :3]), 1.0, abs_tol=1e-12)
    for index, value in param.items():
        new = 0.0 if index + 1 in FLAGS.get(kin, {}) else value + 1e4
        if (kin, index) in {(22, 3), (45, 33)} or (kin, index + 1) in SILENT:
            new = value - 2.0  # 22: 0 and 1 are the same direction; 45: 5 to 3 is another direction of the length
        moved = np.abs(FORMULAS[kin](param | {index: new}, axes, 50.0, {}) - first).max() > 1e-9
        assert moved == ((kin, index + 1) not in SILENT), index
    for i in range(len(axes)):
        other = [value + (3.0 if k == i else 0.0) for k, value in enumerate(axes)]
        assert np.abs(FORMULAS[kin](param, other, 50.0, {}) - first).max() > 1e-3, i


def rank(kin: int) -> int:
    """Returns the numeric rank of the pose over the axis values."""
    param, axes = sample(kin)
    base, columns = FORMULAS[kin](param, axes, 50.0, {}), []
    for i in range(len(axes)):
        ahead = FORMULAS[kin](param, [a + (1e-4 if k == i else 0.0) for k, a in enumerate(axes)], 50.0, {})
        spin = (ahead[:3, :3] - base[:3, :3]) @ base[:3, :3].T * 2e6
        columns.append([*((ahead - base)[:3, 3] * 1e4), spin[2, 1], spin[0, 2], spin[1, 0]])
    return int(np.linalg.matrix_rank(np.array(columns).T, tol=1e-2))


@pytest.mark.parametrize("kin", sorted(FORMULAS))
def test_rank(kin: int) -> None:
    # 70: the virtual CV only redistributes B and A.
    assert rank(kin) == {70: 5}.get(kin, AXIS_COUNT[kin])


ZERO_VECTORS = {3: (0, 0, -1), 5: (0, -1, 0), 6: (0, 0, -1), 45: (1, 0, 0)}


@pytest.mark.parametrize("kin", sorted(FORMULAS))
def test_tool_vector_at_zero(kin: int) -> None:
    axes, extra = [0.0] * AXIS_COUNT[kin], {}
    if kin == 207:
        extra = {"HD4": 90.0}
    expected = (0, -1, 0) if kin == 207 else ZERO_VECTORS.get(kin, (0, 0, 1))
    assert np.allclose(pose(kin, axes, **extra)[:3, 2], expected, atol=1e-12)
    if kin not in (33, 45, 207):
        # The tool length runs against the tool vector: a longer tool brings the tip further from the holder.
        assert np.allclose(pose(kin, axes, 10.0, **extra)[:3, 3], -10.0 * np.array(expected), atol=1e-12)


# ------------------------------------------------------------------ published poses


@pytest.mark.parametrize("name", ["kin9_nut90_1", "kin59_1", "kin45_kr6r900_2", "kin45_tx2_60"])
def test_reference_poses(name: str) -> None:
    truth = json.loads((REFERENCE / f"{name}.json").read_text("utf-8"))
    param = read_lis(REFERENCE / f"{name}.lis")
    assert len(truth["rows"]) > 5
    for row in truth["rows"]:
        T = FORMULAS[truth["kin"]](param, row["axes"], truth["tool_length"], {})
        assert np.abs(T[:3, 3] - row["p"]).max() < 1e-8
        if "R" in row:
            assert np.abs(T[:3, :3] - row["R"]).max() < 1e-8
        if "z" in row:
            assert np.abs(T[:3, 2] - row["z"]).max() < 1e-8
