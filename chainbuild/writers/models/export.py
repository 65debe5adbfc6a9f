"""Several files of a robot at once, in its folder: all of them are made before the first is written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, get_args

from chainbuild.errors import ChainbuildError
from chainbuild.files import file_of, write_text
from chainbuild.writers.models.mjcf import mjcf_text
from chainbuild.writers.models.srdf import srdf_text
from chainbuild.writers.models.urdf import check_robot, urdf_text

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

ExportFormat = Literal["urdf", "mjcf", "srdf"]
FORMATS: Final[tuple[ExportFormat, ...]] = get_args(ExportFormat)
_SUFFIXES: Final[dict[ExportFormat, str]] = {"urdf": "urdf", "mjcf": "xml", "srdf": "srdf"}
_SAMPLES: Final = 10_000  # as `collide --srdf` draws


def export(
    robot: Mechanism,
    folder: Path | str = "urdf_out",
    *,
    formats: Sequence[ExportFormat] = FORMATS,
    samples: int = _SAMPLES,
) -> dict[str, Path]:
    """Write a robot's files to folder/NAME/: URDF, MJCF for MuJoCo, SRDF; return the path of each format.

    Args:
        robot: The robot.
        folder: Folder in which the folder NAME is created.
        formats: Which files.
        samples: Random positions by which the SRDF tells pairs of links that never collide.

    Raises:
        ChainbuildError: the argument is not a robot, there is no such format, or the kinematic has no pose to begin
            with.
        FileAccessError: the folder is not a path, or a file cannot be written.
    """
    check_robot(robot)
    unknown = [one for one in formats if one not in FORMATS]
    if unknown or not formats or isinstance(formats, str):
        shown = f"unknown format {unknown[0]!r:.40}" if unknown else f"the formats are {formats!r:.40}"
        raise ChainbuildError(shown, parameter="formats", permitted=f"a list of {', '.join(FORMATS)}")
    texts = {one: _text(robot, one, samples) for one in dict.fromkeys(formats)}
    paths: dict[str, Path] = {}
    for one, text in texts.items():
        paths[one] = file_of(folder, robot.name, _SUFFIXES[one])
        write_text(paths[one], text)
    return paths


def _text(robot: Mechanism, one: ExportFormat, samples: int) -> str:
    if one == "urdf":
        return urdf_text(robot)
    if one == "mjcf":
        return mjcf_text(robot)
    from chainbuild.analysis.collision.pairs import classify_pairs

    return srdf_text(robot, classify_pairs(robot, samples))
