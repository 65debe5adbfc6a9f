"""Labels in a meshcat scene: text of constant size that faces the viewer and is never hidden by a body."""

from __future__ import annotations

from typing import Any, Final, Literal

import numpy as np

Side = Literal["left", "right", "below"]

_CANVAS_PIXELS: Final = 256  # meshcat writes a text onto a square of this side
_FONT_PIXELS: Final = 60  # a letter fills a quarter of the canvas: sharp, and short names fit
_LETTER_WIDTH: Final = 0.60  # mean width of a sans-serif letter over the font size, rather too wide
_LINE_HEIGHT: Final = 1.35  # over the font size: room for letters below the base line
_BASELINE: Final = 0.27  # meshcat centres the base line, not the letters
_LETTER_SHARE: Final = 0.0150  # font size over the distance to the viewer
_GAP: Final = 0.35  # between a frame's origin and its label, over the font size
_PAPER: Final = 0xFFFFFF  # white


def draw_label(node: Any, text: str, side: Side) -> None:
    """Draw a text beside the origin of a scene node.

    Args:
        node: `meshcat.Visualizer` at the path where the label goes.
        text: One short line.
        side: Position of the text as seen by the viewer.
    """
    font = min(_FONT_PIXELS, int(_CANVAS_PIXELS / (_LETTER_WIDTH * max(len(text), 1))))
    width = min(_LETTER_WIDTH * font * (len(text) + 0.6), _CANVAS_PIXELS)
    height = _LINE_HEIGHT * font
    away = width / 2 + _GAP * font
    low = -height / 2 - _GAP * font
    right, up = {"left": (-away, -low), "right": (away, low), "below": (0.0, low)}[side]
    scale = _LETTER_SHARE / font
    _sprite(node["plate"], None, (width, height), (right, up), scale, order=1)
    lowered = up - _BASELINE * font
    _sprite(node["text"], (text, font), (_CANVAS_PIXELS, _CANVAS_PIXELS), (right, lowered), scale, order=2)


def _sprite(
    node: Any,
    text: tuple[str, int] | None,
    size: tuple[float, float],
    shift: tuple[float, float],
    scale: float,
    order: int,
) -> None:
    """Put one sprite of a size and shift in pixels; `scale` turns pixels into scene units."""
    node.set_object(_sprite_object(text))
    # The anchor of a sprite counts from its lower left corner in shares of its size.
    anchor = {"x": 0.5 - shift[0] / size[0], "y": 0.5 - shift[1] / size[1]}
    node["<object>"].set_property("center", anchor)
    node["<object>"].set_property("renderOrder", order)
    node.set_transform(np.diag([size[0] * scale, size[1] * scale, 1.0, 1.0]))


def _sprite_object(text: tuple[str, int] | None) -> Any:
    """Return a sprite with a text in a font size, or a plain pale one. meshcat's Python side supports neither."""
    from meshcat import geometry

    class Sprite(geometry.Object):
        _type = "Sprite"

    class SpriteMaterial(geometry.GenericMaterial):
        _type = "SpriteMaterial"

    class Text(geometry.Texture):
        def lower(self, object_data: dict[str, Any]) -> dict[str, Any]:
            words, font = text or ("", 1)
            return {"uuid": self.uuid, "type": "_text", "text": words, "font_size": font, "font_face": "sans-serif"}

    look = {"transparent": True, "depthTest": False, "depthWrite": False, "sizeAttenuation": False}
    if text is None:
        material = SpriteMaterial(color=_PAPER, opacity=0.7, **look)
    else:
        material = SpriteMaterial(color=0xFFFFFF, map=Text(), **look)
    return Sprite(geometry.Sphere(1.0), material)
