"""PNG files that others can read; letters that stand where they should."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from chainbuild.painting.marks import Caption, Marks, Stroke
from chainbuild.painting.raster.letters import _STROKES, text_strokes, text_width
from chainbuild.painting.raster.lines import draw_marks
from chainbuild.painting.raster.png import png_bytes


@pytest.mark.parametrize("channels", [3, 4])
def test_others_read_the_pixels(channels: int) -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (7, 5, channels), dtype=np.uint8)
    with Image.open(io.BytesIO(png_bytes(pixels))) as image:
        assert image.mode == {3: "RGB", 4: "RGBA"}[channels]
        assert (np.asarray(image) == pixels).all()


def ground(rows: int = 40, columns: int = 60) -> np.ndarray:
    return np.full((rows, columns, 3), 250, dtype=np.uint8)


def test_lines_lie_where_they_should() -> None:
    pixels = ground()
    draw_marks(pixels, Marks([Stroke(((10.0, 20.5), (50.0, 20.5)), (0.0, 0.0, 0.0), 3.0)]))
    dark = np.argwhere(pixels[..., 0] < 60)
    assert dark.min(axis=0).tolist() == [19, 9]
    assert dark.max(axis=0).tolist() == [21, 50]
    pixels = ground()
    draw_marks(pixels, Marks([Stroke(((30.5, 20.5),), (1.0, 0.0, 0.0), 6.0)]))
    assert pixels[20, 30].tolist() == [255, 0, 0]
    assert np.ptp(np.argwhere(pixels[..., 1] < 100), axis=0).max() <= 6


def test_lines_out_of_the_picture_are_cut() -> None:
    pixels = ground()
    draw_marks(pixels, Marks([Stroke(((-99.0, 5.0), (99.0, 5.0))), Stroke(((-9.0, -9.0), (-5.0, -5.0)), halo=True)]))
    assert (pixels[5, :, 0] < 120).all()
    assert (pixels[12:] == 250).all()


def test_texts_stand_in_the_middle_on_their_line() -> None:
    pixels = ground(40, 200)
    draw_marks(pixels, Marks(captions=[Caption("HHH", 100.0, 30.0, (0.0, 0.0, 0.0), 20.0)]))
    dark = np.argwhere(pixels[..., 0] < 100)
    rows, columns = dark[:, 0], dark[:, 1]
    assert (rows.min(), rows.max()) == pytest.approx((15, 30), abs=1)  # seven tenths of 20 over the line
    assert (columns.min() + columns.max()) / 2.0 == pytest.approx(99.5, abs=1.0)
    assert columns.max() - columns.min() == pytest.approx(text_width("HHH") * 20.0, abs=3.0)


def test_texts_are_set_off_from_what_is_dark() -> None:
    pixels = np.zeros((40, 60, 3), dtype=np.uint8)
    draw_marks(pixels, Marks(captions=[Caption("I", 30.5, 30.0, (0.0, 0.0, 0.0), 20.0)]))
    assert pixels[22, 30].max() < 60
    assert (pixels[22, [28, 32]] > 180).all()
    assert (pixels[22, [24, 36]] == 0).all()


def test_labels_have_all_their_letters() -> None:
    needed = (
        "HD5 = −45 mm MAIN_LENGTH_AB[0] TX3P3_POS trafo[1].param[12] base flange tool workpiece iso front top right"
    )
    needed += "tool_length EXT_AX_OFFSET 0123456789.e+-"
    assert set(needed) <= set(_STROKES)
    assert list(text_strokes("€", 0.0, 0.0, 10.0)) == list(text_strokes("ü", 0.0, 0.0, 10.0))  # a box for what it lacks
    assert list(text_strokes(" ", 0.0, 0.0, 10.0)) == []
    # No two letters look alike but the two minus signs.
    shapes = {letter: tuple(map(tuple, text_strokes(letter, 0.0, 0.0, 10.0))) for letter in _STROKES}
    assert len(set(shapes.values())) == len(shapes) - 1
