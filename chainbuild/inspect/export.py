"""One HTML file in which a robot is moved, without network, server or Python."""

from __future__ import annotations

import base64
import json
import os
import string
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from chainbuild.files import write_text
from chainbuild.inspect.bundle import asset, import_map, viewer_file
from chainbuild.inspect.chain_data import chain_data
from chainbuild.inspect.panel import html_escaped, panel_html
from chainbuild.inspect.presets import presets_of
from chainbuild.inspect.scene import Scene, as_shown, labelled_frames
from chainbuild.inspect.sweep import rest_pose, swept_poses

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from chainbuild.inspect.playback import Playback
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.painting.overlay.measures import Dimension

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
    dimensions: Iterable[Dimension] = (),
) -> Path:
    """Write one self-contained HTML file in which the robot is moved axis by axis, by its pose or by its gizmo.

    The file holds the viewer and the mathematics and loads nothing. It is written in one piece or not at all.

    Args:
        robot: The robot.
        path: The HTML file; an existing one is replaced.
        playback: Rows of a table to play back; see `axes_playback`.
        at: Axis values (n_axes,), mm and degrees, at which the page opens; None: a pose that shows the machine well.
        dimensions: Lengths of the machine data that the page can show; see `chainbuild.dimensions`.

    Returns:
        The path written.

    Raises:
        ChainbuildError: the kinematic has no pose to show, or the file cannot be written.
    """
    target = Path(path)
    write_text(target, page_html(robot, playback=playback, at=at, dimensions=dimensions))
    return target


def page_html(
    robot: Mechanism,
    *,
    playback: Playback | None = None,
    at: ArrayLike | None = None,
    dimensions: Iterable[Dimension] = (),
    embedded: bool = False,
) -> str:
    """Return the text of the page; the same robot gives the same text.

    Args:
        robot: The robot.
        playback: As for `export_page`.
        at: As for `export_page`.
        dimensions: As for `export_page`.
        embedded: Whether the page keeps step with a window around it, as in a notebook.
    """
    from meshcat import Visualizer

    robot = as_shown(robot)
    rest = rest_pose(robot) if at is None else robot.axis_values(at)
    recorder = _Recorder()
    scene = Scene(Visualizer(window=recorder), robot)
    scene.draw(rest, labels=False)
    template = string.Template(asset("page.html"))
    return template.substitute(
        title=html_escaped(robot.chain.title),
        css=asset("page.css"),
        panel=panel_html(robot.chain, scene.grid_cell),
        licences=viewer_file("main.min.js.LICENSE.txt").replace("--", "- -"),
        modules=import_map(),
        viewer=viewer_file("main.min.js"),
        data=_data(
            robot,
            scene,
            rest,
            recorder,
            {
                "playback": playback and playback.data(),
                "given": at is not None,
                "embedded": embedded,
                "dimensions": [_dimension(one, robot) for one in dimensions],
            },
        ),
    )


def _data(robot: Mechanism, scene: Scene, rest: Any, recorder: _Recorder, more: dict[str, Any]) -> str:
    swept = np.array(scene.bounds(robot.q(axes) for axes in swept_poses(robot, rest)))
    bounds = (1 - _SWEPT_SHARE) * np.array(scene.bounds([robot.q(rest)])) + _SWEPT_SHARE * swept
    data = {
        "chain": chain_data(robot.chain, robot.task),
        "presets": presets_of(robot, rest),
        "rest": rest.tolist(),
        "paths": scene.link_paths,
        "bounds": bounds.round(6).tolist(),
        "view": _VIEW,
        "labels": [{"text": text, "frame": frame.name} for text, frame in labelled_frames(robot.chain)],
        "arm": round(scene.triad_length, 6),
        "size": round(scene.size, 6),
        "commands": [base64.b64encode(command).decode("ascii") for command in recorder.commands],
        **more,
    }
    # No text may end the script element.
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def _dimension(one: Dimension, robot: Mechanism) -> dict[str, Any]:
    """Return a length of the machine data as a line in a link, with its name in the file."""
    return {
        "symbol": one.datum.symbol,
        "name": one.datum.name,
        "label": one.label,
        "link": [link.name for link in robot.chain.links].index(one.link),
        "start": one.start.tolist(),
        "end": one.end.tolist(),
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
