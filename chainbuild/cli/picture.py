"""`chainbuild picture`: a picture of a machine."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from chainbuild.cli.show import note, note_undrawn, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions
from chainbuild.painting.views import PictureView

if TYPE_CHECKING:
    from chainbuild.painting.overlay.measures import Dimension


def picture(
    file: str,
    /,
    *,
    output_file: Annotated[Path, Parameter(name=["--output", "-o"])],
    at: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    view: PictureView = "iso",
    dimensions: Annotated[bool, Parameter(negative="")] = False,
    frames: Annotated[bool, Parameter(negative="")] = False,
    axes: Path | None = None,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Draw the machine, as SVG or PNG by the suffix of the output.

    Machine data say where the axes are and nothing of castings: the bodies are assumed by rule. The same machine gives
    the same file on every computer.

    Example: `chainbuild picture kr6r900 -o robot.svg --at 0,-90,90,0,0,0 --frames`

    Args:
        file: A machine file, or the name of a shipped machine.
        output_file: Picture to write: NAME.svg or NAME.png.
        at: Axis values in mm and degrees. Default: the first row of --axes, else every axis at 0 or at the limit next
            to it.
        view: Direction of view; sheet: all four in one picture, front, top and right to one scale; detail: the head
            or wrist from near.
        dimensions: Draw the lengths of the machine data that are not 0, each from where what it places would be
            without it.
        frames: Draw base, flange, tool and workpiece.
        axes: CSV table of axis values: the trace of the tool on the workpiece is drawn.
        options: Which kinematic.
    """
    from chainbuild.painting.picture import picture as write_picture

    machine, robot = options.built(file)
    values, rows = None, None
    if at is not None:
        from chainbuild.cli.axisvalues import values_of

        values = values_of(robot, at)
    if axes is not None:
        from chainbuild.cli.axisvalues import given_rows

        rows = given_rows(robot, (), axes)
    lengths: tuple[Dimension, ...] = ()
    if dimensions:
        lengths = options.dimensions(machine)
        if not lengths:
            note("--dimensions: no length of the machine data that is not 0 places a joint or frame")
    note_undrawn(robot.chain.geometry)
    say(write_picture(robot, output_file, values, view=view, frames=frames, dimensions=lengths, path_axes=rows))
    return 0
