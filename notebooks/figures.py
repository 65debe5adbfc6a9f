"""Pictures in these notebooks: plots in one style, machines as drawings, all as SVG whose bytes running it again keeps."""

from __future__ import annotations

import tempfile
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import matplotlib as mpl
from IPython.display import SVG
from matplotlib.figure import Figure

import chainbuild

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from chainbuild.kinematics.mechanism import Mechanism

# Told apart by people who confuse red and green, too (Okabe and Ito).
BLUE: Final = "#0072B2"
ORANGE: Final = "#D55E00"
GREEN: Final = "#009E73"
YELLOW: Final = "#E69F00"
PURPLE: Final = "#CC79A7"
SKY: Final = "#56B4E9"
INK: Final = "#222222"
GREY: Final = "#8A8A8A"
COLOURS: Final = (BLUE, ORANGE, GREEN, YELLOW, PURPLE, SKY, GREY)

_POINTS: Final = 72.0  # a figure's unit: points in an inch
_STYLE: Final = {
    "svg.fonttype": "none",  # text stays text: small, and the same with every version of a font
    "svg.hashsalt": "chainbuild",  # names inside the file that do not change from run to run
    "path.simplify": False,  # which points it drops depends on the last digit
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
    "font.size": 11.0,
    "axes.titlesize": 12.0,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "lines.linewidth": 2.0,
    "legend.frameon": False,
    "xtick.color": INK,
    "ytick.color": INK,
}
_LEFT, _RIGHT, _BOTTOM, _TOP = 72.0, 24.0, 56.0, 36.0  # points around the axes: room for numbers, a label and a title
_GAP: Final = 84.0  # points between axes side by side, or above one another


def plot(width: float = 640.0, height: float = 360.0, *, rows: int = 1, columns: int = 1, right: float = _RIGHT) -> Any:
    """Return axes to draw on: one, or an array (rows, columns) of them.

    The margins are fixed, not measured from the text: a font that is missing moves no line.

    Args:
        width: Points of the picture.
        height: Points of the picture.
        rows: Number of axes above one another.
        columns: Number of axes side by side.
        right: Points to the right of the last axes, for names beside the lines.
    """
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(width / _POINTS, height / _POINTS))
        across = (width - _LEFT - right - (columns - 1) * _GAP) / columns
        along = (height - _BOTTOM - _TOP - (rows - 1) * _GAP) / rows
        return figure.subplots(
            rows,
            columns,
            gridspec_kw={
                "left": _LEFT / width,
                "right": 1.0 - right / width,
                "bottom": _BOTTOM / height,
                "top": 1.0 - _TOP / height,
                "wspace": _GAP / across,
                "hspace": _GAP / along,
            },
        )


def svg(axes: Axes) -> SVG:
    """Return the plot that axes belong to, for the last line of a cell."""
    stream = StringIO()
    with mpl.rc_context(_STYLE):
        axes.figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return SVG(stream.getvalue())


def drawing(robot: Mechanism, axes: ArrayLike | None = None, **options: Any) -> SVG:
    """Return the drawing of a machine at axis values, for the last line of a cell.

    Args:
        robot: The machine.
        axes: (n_axes,) mm and degrees; None: every axis at 0 or at the limit next to it.
        options: Those of `chainbuild.picture`: view, frames, dimensions, path_axes.
    """
    with tempfile.TemporaryDirectory() as folder:
        return SVG(filename=str(chainbuild.picture(robot, Path(folder) / "machine.svg", axes, **options)))
