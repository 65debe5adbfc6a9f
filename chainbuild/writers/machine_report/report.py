"""The report of a machine: NAME.md, NAME.html and the pictures, for whoever switches a transformation on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild import __version__
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.programmed.display import POSITION_COLUMNS
from chainbuild.comparison.convention_trials import Selection
from chainbuild.errors import ChainbuildError
from chainbuild.formats.machine import Machine
from chainbuild.frames import ANGLE_MODES
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.painting.overlay.measures import dimensions
from chainbuild.writers.machine_report.axes import axes_chapter
from chainbuild.writers.machine_report.checkform import check_chapter, column_title, tool_in_words
from chainbuild.writers.machine_report.checkposes import CheckPoses, check_poses
from chainbuild.writers.machine_report.choices import conventions_chapter, findings_chapter
from chainbuild.writers.machine_report.document.blocks import Chapter, Report, Verbatim, table_block
from chainbuild.writers.machine_report.document.markdown import markdown_text
from chainbuild.writers.machine_report.document.page import page_text
from chainbuild.writers.machine_report.given import DataSource, data_chapter, file_name
from chainbuild.writers.machine_report.reach import reach_chapter
from chainbuild.writers.machine_report.rows import rows_chapters
from chainbuild.writers.machine_report.singular import singular_chapter
from chainbuild.writers.machine_report.views import pictures_chapter
from chainbuild.writers.models.robotfiles import RobotFiles, check_robot, write_robot_files

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.chain.elements import Chain
    from chainbuild.painting.overlay.measures import Dimension

_SAME: Final = 1e-9  # m and parts of directions: a robot is of a machine if its poses are


def write_report(
    robot: Mechanism,
    folder: Path | str = "urdf_out",
    *,
    machine: Machine | None = None,
    selection: Selection | None = None,
) -> Path:
    """Write the report of a machine to folder/NAME/: NAME.html, NAME.md and pictures such as NAME_front.svg.

    It tells what the file says and what each datum moves, what the manuals leave open and how to verify it; it shows
    the machine, its axes, reach, singular positions, Denavit-Hartenberg parameters and screws, and lists poses to
    compare with the control. All texts are made before the first is written; the same machine gives the same files on
    every computer.

    Args:
        robot: The robot.
        folder: Folder in which the folder NAME is created.
        machine: The file it was built from, as `chainbuild.load` returns it; None: the report does without its data.
        selection: Which kinematic of the file the robot is; None: the default.

    Returns:
        The path of the HTML page.

    Raises:
        ChainbuildError: the argument is not a robot, or not one of this machine and selection.
        FileAccessError: the folder is not a path, or a file cannot be written.
    """
    return write_robot_files(robot, folder, report_files(robot, machine, selection))[f"{robot.name}.html"]


def report_files(robot: Mechanism, machine: Machine | None = None, selection: Selection | None = None) -> RobotFiles:
    """Return the files of a report, as `write_report` writes them: name → text.

    Args:
        robot: The robot.
        machine: The file it was built from.
        selection: Which kinematic of the file the robot is; None: the default.

    Raises:
        ChainbuildError: the argument is not a robot, or not one of this machine and selection.
    """
    check_robot(robot)
    report = machine_report(robot, machine, selection)
    pictures = {report.file_of_drawing(drawing): drawing.svg for drawing in report.drawings}
    return {f"{report.name}.md": markdown_text(report), f"{report.name}.html": page_text(report), **pictures}


def machine_report(robot: Mechanism, machine: Machine | None, selection: Selection | None) -> Report:
    """Return the report of a machine as data; see `report_files`."""
    source = None if machine is None else _source(robot, machine, selection or Selection())
    lengths = () if source is None else _lengths(source)
    poses = check_poses(robot)
    rows, screws = rows_chapters(robot)
    chapters = (
        _machine_chapter(robot, source),
        pictures_chapter(robot, lengths),
        findings_chapter(robot.chain.findings),
        conventions_chapter(robot.chain.conventions),
        data_chapter(robot, source),
        axes_chapter(robot, machine),
        reach_chapter(robot),
        singular_chapter(robot, _reference(robot, poses)),
        check_chapter(robot, poses),
        rows,
        screws,
    )
    return Report(f"{robot.chain.title}: commissioning report", robot.name, chapters)


def _machine_chapter(robot: Mechanism, source: DataSource | None) -> Chapter:
    chain = robot.chain
    rows: list[Sequence[str]] = [
        ["Machine", chain.title],
        *([] if chain.kinematic == chain.dialect else [["Kinematic", chain.kinematic]]),
        ["Source" if chain.dialect in ("URDF", "Denavit-Hartenberg") else "Controller", chain.dialect],
    ]
    if source is not None:
        rows.append(["Files read", Verbatim(file_name(source.machine))])
        one = source.selection
        titles = dict.fromkeys(
            entry.title for entry in source.machine.kinematics() if entry.type.startswith(chain.kinematic)
        )
        rows += [["Type", title] for title in list(titles)[:1]]
        if one.tool_length_mm:
            rows.append(["Added tool length", f"{one.tool_length_mm:g} mm"])
    rows += [
        ["Axes", ", ".join(axis.name for axis in chain.axes)],
        ["Tool", tool_in_words(chain)],
        ["A pose", _pose_in_words(chain)],
        ["Made by", f"chainbuild {__version__}"],
    ]
    return Chapter("Machine", [table_block(("", ""), rows, "facts")])


def _pose_in_words(chain: Chain) -> str:
    """Return what the control shows and takes as a pose."""
    shown = ", ".join(column_title(name, chain) for name in (*POSITION_COLUMNS, *chain.display_columns))
    if chain.display.rtcp:
        return f"{shown} (RTCP: position and the machine's own rotary axes)"
    if chain.display.kind == "angles":
        return f"{shown}; angles {chain.angle_mode}: {ANGLE_MODES[chain.angle_mode].meaning}"
    return shown


def _reference(robot: Mechanism, found: CheckPoses) -> Vector:
    if found.poses:
        return found.poses[0].axes
    lower, upper = shown_limits(robot.chain)
    middle: Vector = np.round((lower + upper) / 2.0)
    return middle


def _source(robot: Mechanism, machine: Machine, selection: Selection) -> DataSource:
    """Return where the data of a robot come from.

    Raises:
        ChainbuildError: it is not of this machine.
    """
    conventions = {one.convention.name: one.choice for one in robot.chain.conventions}
    source = DataSource(machine, selection, conventions)
    own, chain = robot.chain, source.chain({})
    places = [
        {**{j.name: j.T_parent_joint for j in one.joints}, **{f.name: f.T_link_frame for f in one.frames}}
        for one in (own, chain)
    ]
    same = all(name in places[0] and np.abs(places[0][name] - T).max() < _SAME for name, T in places[1].items())
    if own.kinematic != chain.kinematic or not same:
        raise ChainbuildError(
            f"the robot is not the kinematic of {machine.path.name} that was selected",
            parameter="selection",
            permitted="the kinematic, channel, tool length and conventions that the robot was built with",
        )
    return source


def _lengths(source: DataSource) -> tuple[Dimension, ...]:
    one = source.selection
    return dimensions(source.machine, one.kinematic, one.channel, one.tool_length_mm, source.conventions)
