"""The files of a robot in its folder: what is written together appears together."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from chainbuild.arrays import Matrix
from chainbuild.errors import ChainbuildError
from chainbuild.files import angle_text, folder_of, place_of, protected, write_all
from chainbuild.frames import urdf_rpy

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
        OverwriteError: a file would take the place of the URDF, or of another mesh, that the robot was read from.
    """
    place = folder_of(folder, robot.name)
    paths = {name: place.joinpath(*name.split("/")) for name in files}
    geometry = robot.chain.geometry
    bodies = (shape for given in (geometry.shapes, geometry.visuals) for shapes in given.values() for shape in shapes)
    read = {shape.file for shape in bodies if shape.file is not None}
    read |= set() if geometry.source is None else {geometry.source}
    places = {place_of(file) for file in read}
    with protected(read):
        write_all(
            {
                path: files[name]
                for name, path in paths.items()
                if place_of(path) not in places or path.read_bytes() != files[name]
            }
        )
    return paths


def rpy_texts(T: Matrix) -> list[str]:
    """Return roll, pitch, yaw [rad] of a place (4, 4) as they are written: roll makes up for the rounding of yaw."""
    return [angle_text(angle) for angle in urdf_rpy(T[:3, :3], lambda angle: float(angle_text(angle)))]


def yaml_number(text: str) -> str:
    """Return a number as YAML reads it: with an exponent, but without a decimal point, it would be a text."""
    digits, e, power = text.partition("e")
    return text if not e or "." in digits else f"{digits}.0e{power}"
