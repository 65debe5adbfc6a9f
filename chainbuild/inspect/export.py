"""One HTML file that shows a robot moving, without network, server or Python."""

from __future__ import annotations

import base64
import json
import os
import string
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from chainbuild.files import write_text
from chainbuild.frames import ANGLE_MODES
from chainbuild.inspect.panel import html_escaped, panel_html
from chainbuild.inspect.scene import Scene, as_shown
from chainbuild.inspect.sweep import FRAMES_PER_SECOND, AxisSweep, axis_sweep
from chainbuild.kinematics.displayed import arm_normal

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from chainbuild.inspect.playback import Playback
    from chainbuild.kinematics.mechanism import Mechanism

# Direction of view: from in front of the machine's right side, slightly from above (machine coordinates).
_VIEW: Final = (1.0, -1.35, 0.75)
# How far the picture reaches from the machine at rest (0) to everything it sweeps over (1).
_SWEPT_SHARE: Final = 0.6


def export_page(
    robot: Mechanism,
    path: str | os.PathLike[str],
    *,
    playback: Playback | None = None,
    at: ArrayLike | None = None,
) -> Path:
    """Write one self-contained HTML file with the robot, its frames and a sweep of each axis.

    The file holds the meshcat viewer itself and loads nothing. It is written in one piece or not at all.

    Args:
        robot: The robot.
        path: The HTML file; an existing one is replaced.
        playback: Rows of a table to play back; see `axes_playback`.
        at: (n_axes,) axis values that the page opens at, mm and degrees.

    Returns:
        The path written.

    Raises:
        AxisValueError: `at` has the wrong number of values, or one that is not finite.
        ChainbuildError: the kinematic has no pose to show, or the file cannot be written.
    """
    target = Path(path)
    write_text(target, page_html(robot, playback, at))
    return target


def page_html(robot: Mechanism, playback: Playback | None = None, at: ArrayLike | None = None) -> str:
    """Return the text of the page; the same robot gives the same text."""
    from meshcat import Visualizer

    opened = None if at is None else robot.axis_values(at).tolist()
    robot = as_shown(robot)
    motion = axis_sweep(robot)
    recorder = _Recorder()
    scene = Scene(Visualizer(window=recorder), robot)
    scene.draw(motion.axes[0])
    scene.animate(motion.q)
    template = string.Template(_asset("page.html"))
    return template.substitute(
        title=html_escaped(robot.chain.title),
        css=_asset("page.css"),
        panel=panel_html(robot.chain, scene.grid_cell, motion.held),
        licences=_viewer_file("main.min.js.LICENSE.txt").replace("--", "- -"),
        viewer=_viewer_file("main.min.js"),
        data=_data(
            robot, scene, motion, recorder, {"playback": None if playback is None else playback.data(), "at": opened}
        ),
        script=_asset("page.js"),
    )


def _data(robot: Mechanism, scene: Scene, motion: AxisSweep, recorder: _Recorder, more: dict[str, Any]) -> str:
    bounds = np.array(scene.bounds(motion.q))
    bounds = (1 - _SWEPT_SHARE) * np.array(scene.bounds(motion.q[:1])) + _SWEPT_SHARE * bounds
    data = {
        "names": [{"name": axis.name, "unit": "°" if axis.unit == "deg" else "\u00a0mm"} for axis in robot.axes],
        "axes": motion.axes.round(6).tolist(),
        "fps": FRAMES_PER_SECOND,
        "segments": [{"axis": s.axis, "first": s.first, "last": s.last} for s in motion.segments],
        "bounds": bounds.round(6).tolist(),
        "view": _VIEW,
        "pose": _pose(robot, scene),
        "commands": [base64.b64encode(command).decode("ascii") for command in recorder.commands],
        **more,
    }
    # No text may end the script element.
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def _pose(robot: Mechanism, scene: Scene) -> dict[str, Any]:
    """Return the data for the displayed tool pose: two frames of the scene, the angles, what is shown of them."""
    chain = robot.chain
    places = {name: scene.frame_place(name) for name in ("tool", "workpiece")}
    total = chain.absolute_c
    return {
        **{name: {"path": path.split("/"), "T": T.ravel().tolist()} for name, (path, T) in places.items()},
        "factors": ANGLE_MODES[chain.angle_mode].factors,
        "display": _display(robot),
        "absoluteC": None if total is None else {"coefficients": total.coefficients, "offset": total.offset},
    }


def _display(robot: Mechanism) -> dict[str, Any]:
    """Return what is displayed beside the position, as the page computes it."""
    chain = robot.chain
    display, still = chain.display, np.zeros(len(chain.axes))
    return {
        "kind": display.kind,
        "axes": display.axes,
        "letters": [column[0].upper() for column in chain.display_columns],
        "turns": list(display.letters),
        "along": chain.tool_column if display.kind == "vector" else "xyz".index(display.along),
        "tool": chain.tool_column,
        "zero": display.zero_deg,
        # The normals of an arm's plane with the first axis at 0 and 90 degrees: between them it turns evenly.
        "normals": [arm_normal(robot.chain, still + at * np.eye(len(still))[0]).tolist() for at in (0.0, 90.0)]
        if display.kind == "pitch"
        else [],
    }


class _Recorder:
    """Replaces meshcat's window and records the commands for the viewer."""

    def __init__(self) -> None:
        self.commands: list[bytes] = []
        self._count = 0

    def send(self, command: Any) -> None:
        import umsgpack

        # meshcat's own identifiers contain the time and the network card's address.
        parts = [getattr(command, "object", None)]
        parts += [getattr(parts[0], name, None) for name in ("geometry", "material")]
        parts.append(getattr(parts[-1], "map", None))
        for part in parts:
            if part is not None:
                self._count += 1
                part.uuid = f"{self._count:08x}-0000-4000-8000-000000000000"
        self.commands.append(umsgpack.packb(command.lower()))


def _asset(name: str) -> str:
    return resources.files("chainbuild.inspect").joinpath("static", name).read_text("utf-8")


def _viewer_file(name: str) -> str:
    return resources.files("meshcat").joinpath("viewer", "dist", name).read_text("utf-8")
