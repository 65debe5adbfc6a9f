"""Several files of a robot at once, in its folder: all of them are made before the first is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, get_args

from chainbuild.comparison.convention_trials import Selection
from chainbuild.errors import ChainbuildError
from chainbuild.writers.models.mjcf import mjcf_text
from chainbuild.writers.models.notes import machine_data
from chainbuild.writers.models.opw import opw_text
from chainbuild.writers.models.robotfiles import RobotFiles, check_robot, write_robot_files
from chainbuild.writers.models.srdf import SRDF_SAMPLES, pair_table, srdf_text
from chainbuild.writers.models.urdf import urdf_files

if TYPE_CHECKING:
    from chainbuild.formats.machine import Machine
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.progress import Progress

ExportFormat = Literal["urdf", "mjcf", "srdf", "opw", "report"]
FORMATS: Final[tuple[ExportFormat, ...]] = get_args(ExportFormat)
_SUFFIXES: Final[Mapping[ExportFormat, str]] = {"mjcf": ".xml", "srdf": ".srdf", "opw": ".opw.yaml"}


def export(
    robot: Mechanism,
    folder: Path | str = "urdf_out",
    *,
    formats: Sequence[ExportFormat] | None = None,
    samples: int = SRDF_SAMPLES,
    inertia: bool = True,
    machine: Machine | None = None,
    selection: Selection | None = None,
) -> dict[str, Path]:
    """Write a robot's files to folder/NAME/ and return the path of each format.

    The formats are "urdf" (with NAME.loops.yaml and meshes where it has any), "mjcf" for MuJoCo, "srdf", "opw", the
    parameters of ortho-parallel arms, and "report" (NAME.html, NAME.md and pictures).

    Args:
        robot: The robot.
        folder: Folder in which the folder NAME is created.
        formats: Which files; None: all that the robot has.
        samples: Random positions by which the SRDF tells pairs of links that never collide.
        inertia: False: a URDF without masses.
        machine: The file that the robot was built from: its data are in the head of the URDF and in the report.
        selection: Which kinematic of the file the robot is; None: the default.

    Raises:
        ChainbuildError: the argument is not a robot, there is no such format, the kinematic has no pose to begin with,
            or it is no ortho-parallel arm and "opw" is asked for.
        FileAccessError: the folder is not a path, a file cannot be written, or a mesh cannot be read.
    """
    source = None if machine is None else (machine, selection or Selection())
    files = export_files(robot, formats, samples, inertia, source)
    paths = write_robot_files(robot, folder, {name: text for own in files.values() for name, text in own.items()})
    return {one: paths[next(iter(own))] for one, own in files.items()}


def export_files(
    robot: Mechanism,
    formats: Sequence[ExportFormat] | None,
    samples: int,
    inertia: bool,
    source: tuple[Machine, Selection] | None,
    progress: Progress = False,
) -> dict[ExportFormat, RobotFiles]:
    """Return the files of each format, the one that gives the format its name first; arguments as for `export`.

    With progress the random positions of the SRDF are counted: nothing else takes as long.

    Raises:
        ChainbuildError: as `export` does.
    """
    check_robot(robot)
    unknown = [one for one in formats or () if one not in FORMATS]
    if unknown or isinstance(formats, str) or (formats is not None and not formats):
        shown = f"unknown format {unknown[0]!r:.40}" if unknown else f"the formats are {formats!r:.40}"
        raise ChainbuildError(shown, parameter="formats", permitted=f"a list of {', '.join(FORMATS)}")
    made: dict[ExportFormat, RobotFiles] = {}
    for one in dict.fromkeys(formats or formats_of(robot)):
        if one == "urdf":
            made[one] = urdf_files(robot, inertia=inertia, data=machine_data(*source) if source else ())
        elif one == "report":
            made[one] = _report(robot, source)
        else:
            made[one] = {robot.name + _SUFFIXES[one]: _text(robot, one, samples, progress)}
    return made


def formats_of(robot: Mechanism) -> tuple[ExportFormat, ...]:
    """Return the formats in which a robot can be written."""
    return tuple(one for one in FORMATS if one != "opw" or opw_text(robot) is not None)


def _text(robot: Mechanism, one: ExportFormat, samples: int, progress: Progress) -> str:
    """Return the file of a format that is one.

    Raises:
        ChainbuildError: the robot has none.
    """
    if one == "mjcf":
        return mjcf_text(robot)
    if one == "srdf":
        return srdf_text(robot, pair_table(robot, samples, progress=progress))
    text = opw_text(robot)
    if text is None:
        permitted = "an ortho-parallel arm of six axes with a spherical wrist"
        raise ChainbuildError("there are no opw parameters of this kinematic", parameter="formats", permitted=permitted)
    return text


def _report(robot: Mechanism, source: tuple[Machine, Selection] | None) -> RobotFiles:
    """Return the files of the report, its page first."""
    from chainbuild.writers.machine_report.report import report_files

    files = report_files(robot, *(source or ()))
    page = f"{robot.name}.html"
    return {page: files[page], **files}
