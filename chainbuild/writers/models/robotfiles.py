"""The files of a robot in its folder: what is written together appears together."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from chainbuild.errors import ChainbuildError
from chainbuild.files import folder_of, write_all

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

# Path in the robot's folder → content.
RobotFiles: TypeAlias = dict[str, str | bytes]


def check_robot(robot: object) -> None:
    """Refuse what is no robot.

    Raises:
        ChainbuildError: it is none.
    """
    from chainbuild.kinematics.mechanism import Mechanism

    if not isinstance(robot, Mechanism):
        raise ChainbuildError(f"expected a robot, got {type(robot).__name__}", permitted="a chainbuild.Robot")


def write_robot_files(robot: Mechanism, folder: Path | str, files: Mapping[str, str | bytes]) -> dict[str, Path]:
    """Write the files of a robot to folder/NAME, all or none, and return their paths by what they are called there.

    Raises:
        FileAccessError: the folder is not a path, or a file cannot be written.
    """
    place = folder_of(folder, robot.name)
    paths = {name: place.joinpath(*name.split("/")) for name in files}
    write_all({paths[name]: content for name, content in files.items()})
    return paths
