"""Two small plots as SVG elements: points over an axis, and a histogram."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Vector

# Pixels of SVG: two plots side by side on a page, and margins with room for labels.
_WIDTH: Final = 340
_HEIGHT: Final = 230
_LEFT: Final = 46
_RIGHT: Final = 10
_TOP: Final = 24
_BOTTOM: Final = 40
_COLOURS: Final = {"random": "#1f6feb", "grid": "#8250df", "singular": "#bc4c00", "recorded": "#1f6feb"}
_TICKS: Final = 5  # about as many as can be read along an axis
_BINS: Final = 24  # about the square root of the usual count of samples
_GREY: Final = "#6e7781"


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Points of a plot.

    Attributes:
        x: (n,) values.
        y: (n,) values; NaN is not drawn.
        kinds: (n,) kind of each point; decides its colour.
    """

    x: Vector
    y: Vector
    kinds: Sequence[str]


@dataclass(frozen=True, slots=True)
class _Scale:
    """A linear map from values to pixels."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Return round values inside the range."""
        raw = (self.high - self.low) / _TICKS
        power = 10.0 ** math.floor(math.log10(raw))
        step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * (1.0 - 1e-12))
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return [n * step for n in range(first, last + 1)]


def scatter(points: Points, title: str, x_label: str, y_label: str, mark: float) -> ET.Element:
    """Return a plot of points with a dashed line at the height of the tolerance."""
    drawn = np.isfinite(points.y) & np.isfinite(points.x)
    x = _scale(points.x[drawn], _LEFT, _WIDTH - _RIGHT)
    y = _scale(np.append(points.y[drawn], mark), _HEIGHT - _BOTTOM, _TOP)
    svg = _frame(title, x_label, y_label, x, y)
    _line(svg, x.start, y(mark), x.end, y(mark))
    for n in np.flatnonzero(drawn).tolist():
        place = {"cx": f"{x(float(points.x[n])):.1f}", "cy": f"{y(float(points.y[n])):.1f}", "r": "2"}
        dot = ET.SubElement(svg, "circle", {**place, "fill": _COLOURS.get(points.kinds[n], _GREY), "opacity": "0.7"})
        ET.SubElement(dot, "title").text = f"{points.kinds[n]}: {points.x[n]:.6g}"
    return svg


def histogram(values: Vector, title: str, x_label: str, mark: float) -> ET.Element:
    """Return a histogram with a dashed line at the tolerance."""
    x = _scale(np.append(values, mark), _LEFT, _WIDTH - _RIGHT)
    counts, edges = np.histogram(values, bins=_BINS, range=(x.low, x.high))
    y = _Scale(0.0, max(1.0, float(counts.max()) * 1.05), _HEIGHT - _BOTTOM, _TOP)
    svg = _frame(title, x_label, "poses", x, y)
    for count, left, right in zip(counts.tolist(), edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        if count:
            size = {"width": f"{max(1.0, x(right) - x(left) - 1.0):.1f}", "height": f"{y.start - y(count):.1f}"}
            bar = ET.SubElement(svg, "rect", {"x": f"{x(left):.1f}", "y": f"{y(count):.1f}", **size, "fill": "#1f6feb"})
            ET.SubElement(bar, "title").text = f"{count} poses"
    _line(svg, x(mark), y.start, x(mark), y.end)
    return svg


def _scale(values: Vector, start: float, end: float) -> _Scale:
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    margin = 0.04 * (high - low) or 1.0
    return _Scale(low - margin, high + margin, start, end)


def _frame(title: str, x_label: str, y_label: str, x: _Scale, y: _Scale) -> ET.Element:
    svg = ET.Element("svg", {"width": str(_WIDTH), "height": str(_HEIGHT), "viewBox": f"0 0 {_WIDTH} {_HEIGHT}"})
    svg.set("role", "img")
    svg.set("aria-label", f"{y_label} {title}")
    corner = {"x": str(_LEFT), "y": str(_TOP)}
    size = {"width": str(_WIDTH - _LEFT - _RIGHT), "height": str(_HEIGHT - _TOP - _BOTTOM)}
    ET.SubElement(svg, "rect", {**corner, **size, "fill": "none", "stroke": "#9aa4af"})
    _text(svg, _WIDTH / 2, 15, title, "middle")
    _text(svg, _WIDTH / 2, _HEIGHT - 6, x_label, "middle")
    label = _text(svg, 12, _HEIGHT / 2, y_label, "middle")
    label.set("transform", f"rotate(-90 12 {_HEIGHT / 2:g})")
    for value in x.ticks():
        _text(svg, x(value), _HEIGHT - _BOTTOM + 14, f"{value:g}", "middle")
    for value in y.ticks():
        _text(svg, _LEFT - 4, y(value) + 4, f"{value:g}", "end")
    return svg


def _text(svg: ET.Element, x: float, y: float, text: str, anchor: str) -> ET.Element:
    place = {"x": f"{x:.1f}", "y": f"{y:.1f}", "text-anchor": anchor, "font-size": "11", "fill": _GREY}
    element = ET.SubElement(svg, "text", place)
    element.text = text
    return element


def _line(svg: ET.Element, x1: float, y1: float, x2: float, y2: float) -> None:
    ends = {"x1": f"{x1:.1f}", "y1": f"{y1:.1f}", "x2": f"{x2:.1f}", "y2": f"{y2:.1f}"}
    ET.SubElement(svg, "line", {**ends, "stroke": "#a40e26", "stroke-dasharray": "4 3"})
