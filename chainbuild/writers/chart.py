"""A chart as SVG elements: a frame with round ticks, lines, bands and images."""

from __future__ import annotations

import base64
import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import Final

from chainbuild.files import printable_tree
from chainbuild.painting.raster.png import Pixels, png_bytes

# Pixels of SVG: margins with room for labels and a legend, and the largest plot between them.
_LEFT: Final = 70.0
_TOP: Final = 40.0
_RIGHT: Final = 90.0
_BOTTOM: Final = 50.0
_WIDTH: Final = 560.0
_HEIGHT: Final = 400.0
_TICKS: Final = 6  # about as many as can be read along an axis
_LINE: Final = 12.0  # of small text
_HAIR: Final = 1.0  # narrower ranges could not be seen
_INK, _GRID = "#24292f", "#d0d7de"


class Chart:
    """One chart with linear axes.

    Args:
        title: Heading.
        x_label: Name and unit of x.
        y_label: Name and unit of y.
        x_range: Values at the left and right border.
        y_range: Values at the lower and upper border.
        square: One unit is as long in both directions.
    """

    def __init__(
        self,
        title: str,
        x_label: str,
        y_label: str,
        x_range: tuple[float, float],
        y_range: tuple[float, float],
        square: bool = False,
    ) -> None:
        self.x_range, self.y_range = _opened(x_range), _opened(y_range)
        self.width, self.height = _WIDTH, _HEIGHT
        if square:
            scale = min(_WIDTH / (self.x_range[1] - self.x_range[0]), _HEIGHT / (self.y_range[1] - self.y_range[0]))
            self.width = scale * (self.x_range[1] - self.x_range[0])
            self.height = scale * (self.y_range[1] - self.y_range[0])
        total = self.width + _LEFT + _RIGHT, self.height + _TOP + _BOTTOM
        self.svg = ET.Element(
            "svg",
            {
                "xmlns": "http://www.w3.org/2000/svg",
                "viewBox": f"0 0 {total[0]:.1f} {total[1]:.1f}",
                "width": f"{total[0]:.0f}",
                "height": f"{total[1]:.0f}",
                "font-family": "sans-serif",
                "font-size": "12",
                "fill": _INK,
            },
        )
        ET.SubElement(self.svg, "rect", {"width": "100%", "height": "100%", "fill": "white"})
        self._text(_LEFT, _TOP - 16.0, title, size="14")
        self._text(_LEFT + self.width / 2.0, _TOP + self.height + 40.0, x_label, anchor="middle")
        y = _TOP + self.height / 2.0
        self._text(18.0, y, y_label, anchor="middle", turn=f"rotate(-90 18 {y:.1f})")
        self._ticks()

    def x(self, value: float) -> float:
        """Return the horizontal position of a value of x."""
        return _LEFT + (value - self.x_range[0]) / (self.x_range[1] - self.x_range[0]) * self.width

    def y(self, value: float) -> float:
        """Return the vertical position of a value of y."""
        return _TOP + (self.y_range[1] - value) / (self.y_range[1] - self.y_range[0]) * self.height

    def line(self, x: Sequence[float], y: Sequence[float], colour: str, dashed: bool = False) -> None:
        """Draw a line through points."""
        points = " ".join(f"{self.x(a):.2f},{self.y(b):.2f}" for a, b in zip(x, y, strict=True))
        style = {"stroke-dasharray": "5 4"} if dashed else {}
        ET.SubElement(
            self.svg, "polyline", {"points": points, "fill": "none", "stroke": colour, "stroke-width": "1.6", **style}
        )

    def band(self, x: Sequence[float], low: Sequence[float], high: Sequence[float], colour: str) -> None:
        """Fill the area between two lines."""
        corners = [*zip(x, low, strict=True), *reversed(list(zip(x, high, strict=True)))]
        points = " ".join(f"{self.x(a):.2f},{self.y(b):.2f}" for a, b in corners)
        ET.SubElement(self.svg, "polygon", {"points": points, "fill": colour, "opacity": "0.35"})

    def stretch(self, begin: float, end: float, colour: str, words: str = "", line: int = 0) -> None:
        """Shade a range of x over the whole height, at least a hair wide, with words on a line below the upper edge."""
        left, width = self.x(begin), max(self.x(end) - self.x(begin), _HAIR)
        box = {"x": f"{left:.2f}", "y": f"{_TOP}", "width": f"{width:.2f}", "height": f"{self.height:.2f}"}
        ET.SubElement(self.svg, "rect", {**box, "fill": colour, "opacity": "0.18"})
        if words:
            self._text(left + width / 2.0, _TOP + _LINE * (line + 1), words, anchor="middle", size="10")

    def mark(self, x: float, y: float, colour: str, filled: bool) -> None:
        """Mark a point with a circle."""
        centre = {"cx": f"{self.x(x):.2f}", "cy": f"{self.y(y):.2f}", "r": "4"}
        look = {"fill": colour if filled else "white", "stroke": colour, "stroke-width": "1.6"}
        ET.SubElement(self.svg, "circle", {**centre, **look})

    def image(self, pixels: Pixels) -> None:
        """Fill the frame with pixels (rows from above, columns, RGBA)."""
        data = base64.b64encode(png_bytes(pixels)).decode("ascii")
        ET.SubElement(
            self.svg,
            "image",
            {
                "x": f"{_LEFT}",
                "y": f"{_TOP}",
                "width": f"{self.width:.2f}",
                "height": f"{self.height:.2f}",
                "preserveAspectRatio": "none",
                "style": "image-rendering:pixelated",
                "href": f"data:image/png;base64,{data}",
            },
        )

    def legend(self, colours: Sequence[str], low: str, high: str, title: str) -> None:
        """Draw a scale of colours at the right, its lowest value below."""
        x, step = _LEFT + self.width + 16.0, self.height / len(colours)
        for n, colour in enumerate(reversed(colours)):
            box = {"x": f"{x}", "y": f"{_TOP + n * step:.2f}", "width": "14", "height": f"{step + 0.5:.2f}"}
            ET.SubElement(self.svg, "rect", {**box, "fill": colour})
        self._text(x + 18.0, _TOP + 10.0, high)
        self._text(x + 18.0, _TOP + self.height, low)
        middle = _TOP + self.height / 2.0
        self._text(x + 46.0, middle, title, anchor="middle", turn=f"rotate(-90 {x + 46.0:.1f} {middle:.1f})")

    def text(self) -> str:
        """Return the SVG."""
        return ET.tostring(printable_tree(self.svg), encoding="unicode") + "\n"

    def _ticks(self) -> None:
        for value in _round_values(*self.x_range):
            x = f"{self.x(value):.2f}"
            ends = {"x1": x, "x2": x, "y1": f"{_TOP}", "y2": f"{_TOP + self.height:.2f}"}
            ET.SubElement(self.svg, "line", {**ends, "stroke": _GRID})
            self._text(self.x(value), _TOP + self.height + 18.0, f"{value:g}", anchor="middle")
        for value in _round_values(*self.y_range):
            y = f"{self.y(value):.2f}"
            ends = {"x1": f"{_LEFT}", "x2": f"{_LEFT + self.width:.2f}", "y1": y, "y2": y}
            ET.SubElement(self.svg, "line", {**ends, "stroke": _GRID})
            self._text(_LEFT - 6.0, self.y(value) + 4.0, f"{value:g}", anchor="end")

    def _text(
        self, x: float, y: float, text: str, anchor: str = "start", size: str = "12", turn: str | None = None
    ) -> None:
        place = {"x": f"{x:.1f}", "y": f"{y:.1f}", "text-anchor": anchor, "font-size": size}
        if turn is not None:
            place["transform"] = turn
        ET.SubElement(self.svg, "text", place).text = text


def _opened(limits: tuple[float, float]) -> tuple[float, float]:
    low, high = limits
    return (low, high) if high - low > 1e-12 else (low - 0.5, high + 0.5)


def _round_values(low: float, high: float) -> list[float]:
    raw = (high - low) / _TICKS
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * (1.0 - 1e-12))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(n * step, 12) + 0.0 for n in range(first, last + 1)]
