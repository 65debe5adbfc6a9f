"""The law of the effective tool length of KIN_TYP 98."""

from __future__ import annotations

import math

import pytest

from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError
from chainbuild.findings import Collector
from chainbuild.formats.twincat.families.minimum_distance import DistanceLaw, distance_law
from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.formats.twincat.recipes.recipe import Params

LAW = DistanceLaw(length_mm=100.0, start_deg=20.0, end_deg=45.0, limit_deg=60.0)


def cos(degrees: float) -> float:
    return math.cos(math.radians(degrees))


def params(strict: bool = True, **hd: float) -> Params:
    raw = {int(name[2:]): value * 10_000.0 for name, value in hd.items()}
    return Params(type_data()[98], raw, tool_length_mm=100.0, collector=Collector(strict=strict))


@pytest.mark.parametrize("tilt", [0.0, 10.0, 20.0, -15.0])
def test_below_the_start_the_length_is_the_tools(tilt: float) -> None:
    assert LAW.effective_mm(tilt) == 100.0
    assert LAW.slope_mm_per_rad(tilt) == 0.0


@pytest.mark.parametrize("tilt", [20.0 + 1e-9, 30.0, 45.0, -30.0])
def test_between_start_and_end_the_head_keeps_its_height(tilt: float) -> None:
    assert LAW.effective_mm(tilt) * cos(tilt) == pytest.approx(100.0 * cos(20.0))


def test_it_joins_at_start_and_end() -> None:
    for tilt in (20.0, 45.0):
        assert LAW.effective_mm(tilt - 1e-7) == pytest.approx(LAW.effective_mm(tilt + 1e-7), abs=1e-5)


@pytest.mark.parametrize("tilt", [45.0, 50.0, 60.0])
def test_beyond_the_end_the_length_stays(tilt: float) -> None:
    assert LAW.effective_mm(tilt) == pytest.approx(100.0 * cos(20.0) / cos(45.0))


@pytest.mark.parametrize("tilt", [60.001, -60.001])
def test_above_the_limit_is_an_error(tilt: float) -> None:
    for evaluate in (LAW.effective_mm, LAW.slope_mm_per_rad):
        with pytest.raises(MachineDataError, match=r"leans by 60\.001.*HD4.*up to 60 deg"):
            evaluate(tilt)


@pytest.mark.parametrize("tilt", [-55.0, -40.0, -30.0, -5.0, 0.0, 5.0, 25.0, 40.0, 44.9, 50.0])
def test_the_slope_is_the_derivative(tilt: float) -> None:
    step = 1e-4
    ahead, behind = LAW.effective_mm(tilt + step), LAW.effective_mm(tilt - step)
    assert LAW.slope_mm_per_rad(tilt) == pytest.approx((ahead - behind) / math.radians(2 * step), abs=1e-6)


def test_hd1_takes_part_only_by_convention() -> None:
    hd = {"hd1": 30.0, "hd2": 20.0, "hd3": 45.0, "hd4": 60.0}
    for choice, extra in (("excluded", 0.0), ("added", 30.0)):
        choose = Choices({"kin98_hd1": choice})
        law = distance_law(params(**hd), choose)
        assert law.effective_mm(0.0) == pytest.approx(100.0 + extra)
        assert law.effective_mm(40.0) == pytest.approx(extra + 100.0 * cos(20.0) / cos(40.0))
        assert law.slope_mm_per_rad(40.0) == pytest.approx(100.0 * cos(20.0) / cos(40.0) * math.tan(math.radians(40)))
        assert choose.unused() == ()
    assert Choices({"kin98_hd1": "added"}).unused() == ("kin98_hd1",)


@pytest.mark.parametrize("hd", [{"hd2": 30.0, "hd3": 20.0}, {"hd2": -1.0, "hd3": 20.0}, {"hd2": 1.0, "hd3": 90.0}])
def test_angles_that_contradict_each_other_are_refused(hd: dict[str, float]) -> None:
    with pytest.raises(MachineDataError, match="HD2 is"):
        distance_law(params(hd4=80.0, **hd), Choices())
    lenient = params(strict=False, hd4=80.0, **hd)
    assert distance_law(lenient, Choices()).effective_mm(70.0) == 100.0
    assert [finding.code for finding in lenient.collector.findings] == ["CB401"]


@pytest.mark.parametrize(("start", "end"), [(0.0, 40.0), (30.0, 30.0), (0.0, 0.0)])
def test_limiting_angles_are_accepted(start: float, end: float) -> None:
    law = distance_law(params(hd2=start, hd3=end, hd4=60.0), Choices())
    assert law.effective_mm(50.0) == pytest.approx(100.0 * cos(start) / cos(end))
