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
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike

    from chainbuild.arrays import Vector
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
    more: Mapping[str, Any] | None = None,
    connects: str = "",
) -> str:
    """Return the text of the page; the same robot gives the same text.

    Args:
        robot: The robot.
        playback: As for `export_page`.
        at: As for `export_page`.
        dimensions: As for `export_page`.
        more: Further data of the page, by name.
        connects: The address that the page may connect to; empty: none.
    """
    robot = as_shown(robot)
    rest = rest_pose(robot) if at is None else robot.axis_values(at)
    shown, scene = _shown(robot, rest, dimensions)
    data = {
        **shown,
        "presets": presets_of(robot, rest),
        "rest": rest.tolist(),
        "bounds": _bounds(robot, scene, rest),
        "view": _VIEW,
        "playback": playback and playback.data(),
        "given": at is not None,
        **(more or {}),
    }
    template = string.Template(asset("page.html"))
    return template.substitute(
        title=html_escaped(robot.chain.title),
        css=asset("page.css"),
        panel=panel_html(robot.chain, scene.grid_cell),
        connects=f" connect-src {connects};" if connects else "",
        licences=viewer_file("main.min.js.LICENSE.txt").replace("--", "- -"),
        modules=import_map(),
        viewer=viewer_file("main.min.js"),
        # No text may end the script element.
        data=json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"),
    )


def model_data(robot: Mechanism, axes: Vector, dimensions: Iterable[Dimension] = ()) -> dict[str, Any]:
    """Return what the page knows of a robot, to be shown in place of another: chain, scene, lengths; no named poses.

    Args:
        robot: The robot, as `as_shown` returns it.
        axes: (n_axes,) axis values, mm and degrees, with a pose.
        dimensions: As for `export_page`.
    """
    shown, scene = _shown(robot, axes, dimensions)
    return {**shown, "bounds": _bounds(robot, scene, axes)}


def shade_data(robot: Mechanism, axes: Vector, root: str) -> dict[str, Any]:
    """Return what the page needs to draw a further robot beside its own: chain and bodies, no frames.

    Args:
        robot: The robot, as `as_shown` returns it.
        axes: (n_axes,) axis values, mm and degrees, with a pose.
        root: Name of its place in the scene.
    """
    recorder = _Recorder()
    scene = Scene(_visualizer(recorder), robot, root)
    scene.draw_robot(axes, frames=False)
    return {
        "chain": chain_data(robot.chain, robot.task),
        "paths": scene.link_paths,
        "rest": axes.tolist(),
        "commands": recorder.texts,
    }


def _visualizer(recorder: _Recorder) -> Any:
    from meshcat import Visualizer

    return Visualizer(window=recorder)


def _shown(robot: Mechanism, axes: Vector, dimensions: Iterable[Dimension]) -> tuple[dict[str, Any], Scene]:
    """Return the data of a robot that do not depend on what else the page shows, and the scene drawn for it."""
    recorder = _Recorder()
    scene = Scene(_visualizer(recorder), robot)
    scene.draw(axes, labels=False)
    data = {
        "chain": chain_data(robot.chain, robot.task),
        "paths": scene.link_paths,
        "labels": [{"text": text, "frame": frame.name} for text, frame in labelled_frames(robot.chain)],
        "arm": round(scene.triad_length, 6),
        "size": round(scene.size, 6),
        "dimensions": [_dimension(one, robot) for one in dimensions],
        "commands": recorder.texts,
    }
    return data, scene


def _bounds(robot: Mechanism, scene: Scene, rest: Vector) -> list[list[float]]:
    """Return the lowest and the highest x, y, z [m] of what the picture shows."""
    swept = np.array(scene.bounds(robot.q(axes) for axes in swept_poses(robot, rest)))
    bounds = (1 - _SWEPT_SHARE) * np.array(scene.bounds([robot.q(rest)])) + _SWEPT_SHARE * swept
    found: list[list[float]] = bounds.round(6).tolist()
    return found


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

    @property
    def texts(self) -> list[str]:
        """The commands as text."""
        return [base64.b64encode(command).decode("ascii") for command in self.commands]

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
