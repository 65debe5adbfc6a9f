"""Tables as DataFrames. pandas is no dependency, not even of the tests: what it is handed is looked at."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from chainbuild import ChainbuildError, IkTable, Robot

AXES = [10.0, -80.0, 70.0, 20.0, 40.0, 30.0]


class DataFrame:
    """Takes columns as pandas does: by name, all of one length."""

    def __init__(self, columns: dict[str, Any]) -> None:
        assert len({len(column) for column in columns.values()}) == 1
        self.columns = list(columns)
        self.values = columns

    def __getitem__(self, name: str) -> Any:
        return self.values[name]


@pytest.fixture
def stub(monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("pandas")
    module.DataFrame = DataFrame  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pandas", module)


def table(units: Any = "controller") -> IkTable:
    robot = Robot.load("kr6r900")
    T, far = robot.fk(AXES).homogeneous, np.eye(4)
    far[0, 3] = 9.0
    return robot.ik_batch([T, far], units=units)


@pytest.mark.usefixtures("stub")
def test_columns_are_axes_status_errors_and_reason() -> None:
    rows = table()
    frame = rows.to_pandas()
    assert frame.columns[:6] == [f"A{n}" for n in range(1, 7)]
    assert frame.columns[6:] == ["status", "position_error_mm", "rotation_error_deg", "reason"]
    assert list(frame["status"]) == ["ok", "unreachable"]
    assert list(frame["reason"]) == ["", rows[1].reason]
    assert rows[1].reason
    np.testing.assert_allclose(frame["A2"], rows.axes[:, 1])
    np.testing.assert_allclose(frame["position_error_mm"], 1000.0 * rows.position_error)
    np.testing.assert_allclose(frame["rotation_error_deg"], np.degrees(rows.rotation_error))


@pytest.mark.usefixtures("stub")
def test_in_si_the_errors_are_too() -> None:
    rows = table("si")
    frame = rows.to_pandas()
    assert frame.columns[-3:] == ["position_error_m", "rotation_error_rad", "reason"]
    np.testing.assert_allclose(frame["A2"], rows.axes[:, 1])
    np.testing.assert_allclose(frame["position_error_m"], rows.position_error)


def test_without_pandas_it_is_said_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ChainbuildError, match=r"pandas is not installed.*pip install pandas"):
        table().to_pandas()
