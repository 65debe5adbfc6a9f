"""A running C whose last axis ends exactly at its limit: a stretched arm is off by more than rounding."""

from __future__ import annotations

import pytest

from chainbuild.robot import Robot

SCARA = Robot.load("scara_cc")


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("elbow", [0.0, -30.0, -145.0])
@pytest.mark.parametrize("start", [None, (-20.0, 0.0, 0.0, 0.0), (-20.0, 20.0, 30.0, 0.0)])
def test_a_value_on_its_limit_is_inside(side: float, elbow: float, start: tuple[float, ...] | None) -> None:
    axes = [-20.0, side * (-130.0 - elbow), side * elbow, side * 1080.0]
    assert not SCARA.limits.violated(SCARA.axis_values(axes))
    T = SCARA.fk(axes)
    found = SCARA.ik(T, start, absolute_c_deg=side * -950.0)
    assert found.success, found.reason
    assert SCARA.chain.absolute_c is not None
    assert SCARA.chain.absolute_c.value(found.axes) == pytest.approx(side * -950.0, abs=1e-4)
    assert abs(found.axes[3]) <= 1080.0
    assert SCARA.fk(found.axes).translation == pytest.approx(T.translation, abs=1e-6)


def test_what_is_beyond_the_limit_is_still_refused_and_says_by_how_much() -> None:
    T = SCARA.fk([-20.0, -130.0, 0.0, 1080.0])
    found = SCARA.ik(T, absolute_c_deg=-950.01)
    assert not found.success
    found = SCARA.ik(T, absolute_c_deg=-950.0 - 360.0)
    assert (found.status, found.violated) == ("limits", ("A4",))
    assert "1440" in found.reason
