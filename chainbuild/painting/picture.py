"""A picture of a machine as a file: from one side or from four, with frames, lengths and the trace of the tool."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, get_args

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.files import as_path, open_binary_atomic, write_text
from chainbuild.kinematics.inputs import axis_rows
from chainbuild.painting.colours import INK_COLOUR
from chainbuild.painting.marks import Caption, Marks
from chainbuild.painting.overlay.dimensions import draw_dimensions
from chainbuild.painting.overlay.placing import LabelBox, Wish, label_width, place_labels
from chainbuild.painting.overlay.trace import draw_trace
from chainbuild.painting.overlay.triads import draw_triads
from chainbuild.painting.raster.lines import draw_marks
from chainbuild.painting.raster.pixels import painted
from chainbuild.painting.raster.png import png_bytes
from chainbuild.painting.raster.sight import render
from chainbuild.painting.stage import Stage, coordinate, framed, within
from chainbuild.painting.vector.svg import Sheet
from chainbuild.painting.views import BACK, VIEWS, PictureView, View, ViewName, Window

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.painting.overlay.measures import Dimension

_SIZE: Final = (960, 720)  # pixels of a picture
_PANE: Final = (640, 480)  # of each of the four on a sheet
_MARGIN: Final = 36  # pixels around the machine
_LABELLED: Final = 52  # likewise with room for names
_COARSE: Final = 4  # pixels in one: fine enough to tell where bodies are
_TITLE: Final = 15.0  # pixels of text: the name of a view
_AWAY: Final = 0.6  # cosine: a tool that hangs down, 0.44, is seen from the front
# What stands where on a sheet: above the front what is seen from above, beside it what is seen from the right.
_SHEET: Final[tuple[tuple[ViewName, int, int], ...]] = (("top", 0, 0), ("iso", 1, 0), ("front", 0, 1), ("right", 1, 1))


@dataclass(frozen=True, slots=True)
class _Pane:
    """A view and its part of the picture."""

    view: View
    window: Window
    x: int
    y: int
    title: str = ""


def picture(
    robot: Mechanism,
    path: Path | str,
    axes: ArrayLike | None = None,
    *,
    view: PictureView = "iso",
    frames: bool = False,
    dimensions: Iterable[Dimension] = (),
    path_axes: ArrayLike | None = None,
) -> Path:
    """Write a picture of a machine, as SVG or PNG by the suffix of its name.

    The same machine gives the same bytes on every processor. A machine that has meshes is painted in pixels, in an
    SVG, too.

    Args:
        robot: The machine.
        path: The file, NAME.svg or NAME.png; an existing one is replaced.
        axes: Axis values (n_axes,), mm and degrees; None: those of the first row of `path_axes`, else every axis at
            0 or at the limit next to it.
        view: From where; "sheet": from all four sides, the plain ones to one scale; "detail": the head or wrist
            from near.
        frames: Whether base, flange, tool and workpiece are drawn.
        dimensions: Lengths of the machine data to draw, as `chainbuild.dimensions` returns them.
        path_axes: Rows of axis values (n, n_axes): the trace of the tool on the workpiece is drawn.

    Returns:
        The path written.

    Raises:
        AxisValueError: axis values of the wrong count, or not finite.
        FileAccessError: the file cannot be written.
        ChainbuildError: another suffix or view, or the machine has no pose there.
    """
    target = as_path(path)
    suffix = target.suffix.lower()
    if suffix not in (".svg", ".png"):
        shown = f"the suffix {target.suffix}" if target.suffix else "no suffix"
        raise ChainbuildError(f"{target.name[:80]}: {shown} says no kind of picture", permitted=".svg, .png")
    if view not in get_args(PictureView):
        raise ChainbuildError(f"there is no view {view!r:.40}", permitted=", ".join(get_args(PictureView)))
    rows = None if path_axes is None else axis_rows(robot.axes, path_axes)
    if rows is not None and not len(rows):
        raise AxisValueError("the path has no rows", permitted="one row at least")
    stage = Stage(robot, rows[0] if axes is None and rows is not None else axes)
    trace = None if rows is None else stage.trace(rows)
    lengths = tuple(dimensions)
    panes, size = _panes(stage, view, trace, labelled=frames or bool(lengths))
    marks = _marks(stage, panes, lengths, trace, frames=frames)
    if suffix == ".svg":
        write_text(target, _svg(stage, panes, size, marks))
    else:
        data = _png(stage, panes, size, marks)
        with open_binary_atomic(target) as stream:
            stream.write(data)
    return target


def _panes(
    stage: Stage, view: PictureView, trace: Matrix | None, *, labelled: bool
) -> tuple[list[_Pane], tuple[int, int]]:
    """Return the views of a picture, and its size in pixels."""
    margin = _LABELLED if labelled else _MARGIN
    points = [] if trace is None else trace.tolist()
    if view == "detail":
        seen = seen_from(stage.pointing)
        return [_Pane(seen, framed(stage.tool_end, seen, *_SIZE, margin), 0, 0)], _SIZE
    if view != "sheet":
        window = framed(stage.bodies, VIEWS[view], *_SIZE, margin, points)
        return [_Pane(VIEWS[view], window, 0, 0)], _SIZE
    windows = {name: framed(stage.bodies, VIEWS[name], *_PANE, margin, points) for name, _, _ in _SHEET}
    scale = min(window.scale for name, window in windows.items() if name != "iso")
    panes = [
        _Pane(
            VIEWS[name],
            windows[name] if name == "iso" else windows[name].rescaled(scale),
            _PANE[0] * column,
            _PANE[1] * row,
            name,
        )
        for name, column, row in _SHEET
    ]
    return panes, (2 * _PANE[0], 2 * _PANE[1])


def seen_from(pointing: Vector) -> View:
    """Return the view of a detail: from behind where a tool points away, so that its tip is seen."""
    length = float(np.sqrt((pointing * pointing).sum()))
    away = -coordinate(pointing, VIEWS["iso"].toward)
    return BACK if length > 0.0 and away > _AWAY * length else VIEWS["iso"]


def drawing_svg(
    stage: Stage, view: ViewName, size: tuple[int, int], lengths: Sequence[Dimension], called: Mapping[str, str]
) -> str:
    """Return a picture of a machine with its frames and lengths as SVG.

    Args:
        stage: The machine.
        view: From where.
        size: Its width and height in pixels.
        lengths: Lengths of the machine data to draw.
        called: Name of a frame → its label, where that is another.
    """
    panes = [_Pane(VIEWS[view], framed(stage.bodies, VIEWS[view], *size, _LABELLED), 0, 0)]
    return _svg(stage, panes, size, _marks(stage, panes, lengths, None, frames=True, called=called))


def _marks(
    stage: Stage,
    panes: Sequence[_Pane],
    lengths: Sequence[Dimension],
    trace: Matrix | None,
    *,
    frames: bool,
    called: Mapping[str, str] | None = None,
) -> Marks:
    """Return what is drawn over the bodies, in pixels of the whole picture."""
    marks = Marks()
    for pane in panes:
        window = pane.window.moved(pane.x, pane.y)
        area: LabelBox = (pane.x, pane.y, pane.x + window.width, pane.y + window.height)
        if pane.title:
            middle = pane.x + _TITLE + label_width(pane.title, _TITLE) / 2.0
            marks.captions.append(Caption(pane.title, middle, pane.y + 2.0 * _TITLE, INK_COLOUR, _TITLE))
        wishes: list[Wish] = []
        if trace is not None:
            draw_trace(marks, trace, pane.view, window)
        wishes += draw_dimensions(marks, lengths, stage, pane.view, window)
        if frames:
            wishes += draw_triads(marks, stage, pane.view, window, called)
        if wishes:
            place_labels(marks, wishes, area, _covering(stage, pane))
    return marks


def _covering(stage: Stage, pane: _Pane) -> Callable[[LabelBox], float]:
    """Return a function of a box in pixels of the whole picture: the share of it that lies on bodies."""
    drawn = render(stage.bodies, pane.view, pane.window.coarser(_COARSE)).bodies >= 0

    def share(box: LabelBox) -> float:
        left, upper, right, lower = (
            int((edge - start) / _COARSE) for edge, start in zip(box, (pane.x, pane.y) * 2, strict=True)
        )
        return float(drawn[upper : lower + 1, left : right + 1].mean())

    return share


def _svg(stage: Stage, panes: Sequence[_Pane], size: tuple[int, int], marks: Marks) -> str:
    sheet = Sheet(*size)
    for pane in panes:
        shown = within(stage.bodies, pane.view, pane.window)
        if any(placed.body.kind == "mesh" for placed in shown):
            # As polygons its triangles would make a file of many MB, and hide each other in minutes.
            sheet.place(painted(shown, pane.view, pane.window), pane.x, pane.y)
            continue
        sheet.paint(shown, pane.view, pane.window.moved(pane.x, pane.y))
    sheet.mark(marks)
    return sheet.text()


def _png(stage: Stage, panes: Sequence[_Pane], size: tuple[int, int], marks: Marks) -> bytes:
    pixels = np.zeros((size[1], size[0], 3), dtype=np.uint8)
    for pane in panes:
        window = pane.window
        rows, columns = slice(pane.y, pane.y + window.height), slice(pane.x, pane.x + window.width)
        pixels[rows, columns] = painted(stage.bodies, pane.view, window)
    draw_marks(pixels, marks)
    return png_bytes(pixels)
