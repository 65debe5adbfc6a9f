"""A picture as SVG: filled faces, round bodies with gradients, lines over them; coordinates are tenths of a pixel."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import Final

from chainbuild.chain.bodies.body import Body, Colour
from chainbuild.files import printable_tree
from chainbuild.painting.colours import GAIN, GROUND_COLOUR, INK_COLOUR, LIGHT, MIDDLE, hex_colour, lit
from chainbuild.painting.marks import HALO, Marks
from chainbuild.painting.raster.png import Pixels, png_bytes
from chainbuild.painting.stage import PlacedBody
from chainbuild.painting.vector.facets import (
    CONTACT_EDGE,
    CREASE_EDGE,
    OUTLINE_EDGE,
    SIDE_FACE,
    Facet,
    Hull,
    dot,
    hull_of,
)
from chainbuild.painting.vector.hiding import seen_pieces
from chainbuild.painting.vector.joining import border, chained
from chainbuild.painting.views import Spot, View, Window

# Tenths of a pixel.
_BOLD: Final = "11"  # where a body ends
_THIN: Final = "5"  # where faces meet
_SEAM: Final = "6"  # a border in a face's own colour, so that no ground shows between two faces
_ROUND: Final = {"stroke-linejoin": "round", "stroke-linecap": "round"}
_STOPS: Final = 4  # of a gradient across a round body, from the first


class Sheet:
    """An SVG picture that is being painted.

    Args:
        width: Pixels.
        height: Pixels.
    """

    def __init__(self, width: int, height: int) -> None:
        size = {"viewBox": f"0 0 {width}0 {height}0", "width": f"{width}", "height": f"{height}"}
        self.root = ET.Element("svg", {"xmlns": "http://www.w3.org/2000/svg", **size, "font-family": "sans-serif"})
        self._definitions = ET.SubElement(self.root, "defs")
        ET.SubElement(self.root, "rect", {"width": "100%", "height": "100%", "fill": hex_colour(GROUND_COLOUR)})

    def paint(self, placed: Sequence[PlacedBody], view: View, window: Window) -> None:
        """Paint bodies.

        Args:
            placed: The bodies.
            view: From where one looks.
            window: What of it fills the picture.
        """
        hulls = [hull_of(body, view, window.scale) for body in placed]
        brush = _Brush(placed, hulls, view, window, self._definitions)
        parent = ET.SubElement(self.root, "g", {"stroke-width": _SEAM, **_ROUND})
        for number, pieces in enumerate(seen_pieces(hulls, view.toward)):
            brush.fill(parent, number, pieces)
        brush.draw_lines(parent)

    def place(self, pixels: Pixels, x: int, y: int) -> None:
        """Put in a picture of pixels at a place."""
        height, width, _ = pixels.shape
        data = base64.b64encode(png_bytes(pixels)).decode("ascii")
        box = {"x": tenths(x), "y": tenths(y), "width": tenths(width), "height": tenths(height)}
        ET.SubElement(self.root, "image", {**box, "href": f"data:image/png;base64,{data}"})

    def mark(self, marks: Marks) -> None:
        """Draw lines, then texts."""
        ground = hex_colour(GROUND_COLOUR)
        parent = ET.SubElement(self.root, "g", {"fill": "none", **_ROUND})
        for stroke in marks.strokes:
            data = path_data(stroke.spots) or _dot(stroke.spots[0])
            if stroke.halo:
                width = tenths(stroke.width + 2.0 * HALO)
                ET.SubElement(
                    parent, "path", {"d": data, "stroke": ground, "stroke-width": width, "stroke-opacity": ".85"}
                )
            ink = {"stroke": hex_colour(stroke.colour), "stroke-width": tenths(stroke.width)}
            ET.SubElement(parent, "path", {"d": data, **ink})
        for caption in marks.captions:
            place = {"x": tenths(caption.x), "y": tenths(caption.y), "text-anchor": "middle"}
            halo = {"stroke": ground, "stroke-width": tenths(2.0 * HALO), "paint-order": "stroke"}
            font = {"font-size": tenths(caption.size), "fill": hex_colour(caption.colour)}
            ET.SubElement(self.root, "text", {**place, **halo, **font, "stroke-linejoin": "round"}).text = caption.text

    def text(self) -> str:
        """Return the SVG."""
        return ET.tostring(printable_tree(self.root), encoding="unicode") + "\n"


class _Brush:
    """Paints what is seen of bodies into an SVG."""

    def __init__(
        self, placed: Sequence[PlacedBody], hulls: Sequence[Hull], view: View, window: Window, definitions: ET.Element
    ) -> None:
        self._placed, self._hulls, self._view, self._window = placed, hulls, view, window
        self._definitions = definitions
        self._fills: dict[int, str] = {}
        self._lines: dict[int, dict[tuple[Spot, Spot], None]] = {OUTLINE_EDGE: {}, CREASE_EDGE: {}}

    def fill(self, parent: ET.Element, number: int, pieces: Sequence[Facet]) -> None:
        """Paint the faces of a body, and keep their lines."""
        view, window = self._view, self._window
        for face in sorted({piece.face for piece in pieces}):
            flat = [
                ([window.spot(view, point) for point in piece.points], piece.edges)
                for piece in pieces
                if piece.face == face
            ]
            edges = border(flat)
            data = "".join(path_data(chain) for chain in chained((a, b) for a, b, _ in edges))
            if data:
                seam = hex_colour(self._colour(number, face))
                ink = {"fill": self._fill(number, face), "stroke": seam}
                ET.SubElement(parent, "path", {"d": data, **ink})
            for a, b, kind in edges:
                found = self._lines.get(CREASE_EDGE if kind == CONTACT_EDGE else kind)
                if found is not None and (b, a) not in found:
                    found[a, b] = None

    def draw_lines(self, parent: ET.Element) -> None:
        """Draw the lines of all faces over them."""
        for kind, width in ((CREASE_EDGE, _THIN), (OUTLINE_EDGE, _BOLD)):
            data = "".join(path_data(chain) for chain in chained(self._lines[kind]))
            if data:
                ink = {"fill": "none", "stroke": hex_colour(INK_COLOUR), "stroke-width": width}
                ET.SubElement(parent, "path", {"d": data, **ink})

    def _shade(self, normal: Sequence[float]) -> float:
        view = self._view
        seen = dot(normal, view.right), dot(normal, view.up), dot(normal, view.toward)
        return MIDDLE + GAIN * dot(LIGHT, seen)

    def _colour(self, number: int, face: int) -> Colour:
        """Return the colour of a face, in the middle of a round one."""
        body, hull = self._placed[number].body, self._hulls[number]
        if _is_flat(body, face):
            normal = hull.normal(face)
        else:
            normal = hull.axes[1] if body.kind == "cylinder" else self._view.toward
        return lit(body.colour, self._shade(normal))

    def _fill(self, number: int, face: int) -> str:
        """Return the colour of a face, or its gradient."""
        body = self._placed[number].body
        if _is_flat(body, face):
            return hex_colour(self._colour(number, face))
        if number not in self._fills:
            name = f"g{len(self._definitions)}"
            self._fills[number] = f"url(#{name})"
            (self._across if body.kind == "cylinder" else self._around)(name, number)
        return self._fills[number]

    def _across(self, name: str, number: int) -> None:
        """Define the gradient across a cylinder, from one outline to the other."""
        body, hull = self._placed[number].body, self._hulls[number]
        x, y, _ = hull.axes
        radius = body.dimensions[0]
        begin, end = (
            self._window.spot(self._view, [c + sign * radius * d for c, d in zip(hull.centre, x, strict=True)])
            for sign in (-1.0, 1.0)
        )
        ends = {"x1": tenths(begin[0]), "y1": tenths(begin[1]), "x2": tenths(end[0]), "y2": tenths(end[1])}
        gradient = ET.SubElement(
            self._definitions, "linearGradient", {"id": name, "gradientUnits": "userSpaceOnUse", **ends}
        )
        for k in range(_STOPS + 1):
            t = -1.0 + 2.0 * k / _STOPS
            normal = [t * a + max(1.0 - t * t, 0.0) ** 0.5 * b for a, b in zip(x, y, strict=True)]
            self._stop(gradient, k / _STOPS, lit(body.colour, self._shade(normal)))

    def _around(self, name: str, number: int) -> None:
        """Define the gradient of a ball, from where the light falls straight on it."""
        body, hull = self._placed[number].body, self._hulls[number]
        radius = body.dimensions[0] * self._window.scale
        u, v = self._window.spot(self._view, hull.centre)
        across = (LIGHT[0] ** 2 + LIGHT[1] ** 2) ** 0.5
        circle = {"cx": u + LIGHT[0] * radius, "cy": v - LIGHT[1] * radius, "r": (1.0 + across) * radius}
        places = {key: tenths(value) for key, value in circle.items()}
        gradient = ET.SubElement(
            self._definitions, "radialGradient", {"id": name, "gradientUnits": "userSpaceOnUse", **places}
        )
        for k in range(_STOPS + 1):
            # From the brightest point through the middle to the far side of the outline.
            t = across - (1.0 + across) * k / _STOPS
            cosine = t * across + max(1.0 - t * t, 0.0) ** 0.5 * LIGHT[2]
            self._stop(gradient, k / _STOPS, lit(body.colour, MIDDLE + GAIN * cosine))

    def _stop(self, gradient: ET.Element, offset: float, colour: tuple[float, float, float]) -> None:
        ET.SubElement(gradient, "stop", {"offset": f"{offset:.3g}", "stop-color": hex_colour(colour)})


def _is_flat(body: Body, face: int) -> bool:
    return body.kind == "box" or (body.kind == "cylinder" and face != SIDE_FACE)


def path_data(spots: Sequence[Spot]) -> str:
    """Return a line as an SVG path, closed where it ends as it begins; "" for one too short to be seen.

    Corners are told from one to the next, which is shorter.
    """
    rounded = [(round(10.0 * x), round(10.0 * y)) for x, y in spots]
    rounded = [here for n, here in enumerate(rounded) if n == 0 or here != rounded[n - 1]]
    closed = spots[0] == spots[-1]
    if len(rounded) < (4 if closed else 2):
        return ""
    (x, y), *others = rounded[: -1 if closed else None]
    words = [f"M{x} {y}l"]
    for here in others:
        words.append(f"{here[0] - x} {here[1] - y}")
        x, y = here
    return f"{words[0]}{' '.join(words[1:])}{'z' if closed else ''}".replace(" -", "-")


def _dot(spot: Spot) -> str:
    """Return a line without length, which round ends make a dot."""
    return f"M{tenths(spot[0])} {tenths(spot[1])}h0"


def tenths(value: float) -> str:
    """Return pixels as text, in tenths."""
    return f"{round(10.0 * value)}"
