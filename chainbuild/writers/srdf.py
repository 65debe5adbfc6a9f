"""SRDF: pairs of links that need no collision check, and passive joints, for MoveIt and other readers."""

from __future__ import annotations

import io
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import TYPE_CHECKING, Final

from chainbuild.files import file_of, write_text

if TYPE_CHECKING:
    from chainbuild.analysis.collision.pairs import PairTable, Verdict
    from chainbuild.kinematics.mechanism import Mechanism

_REASONS: Final[tuple[tuple[Verdict, str], ...]] = (("adjacent", "Adjacent"), ("always", "Always"), ("never", "Never"))


def srdf_text(robot: Mechanism, table: PairTable) -> str:
    """Return the SRDF of a robot with the pairs that need no check, and the joints of loops that no axis drives."""
    root = ET.Element("robot", name=robot.name)
    root.append(
        ET.Comment(
            f" Pairs by {table.samples} positions drawn {_where(robot)}. With {table.confidence:.0%} "
            f"confidence a pair listed as Never touches at less than {table.bound:.2g} of all positions. "
        )
    )
    axes = {axis.name for axis in robot.axes}
    for joint in robot.chain.joints if robot.chain.loops else ():
        if joint.name not in axes:
            ET.SubElement(root, "passive_joint", name=joint.name)
    for verdict, reason in _REASONS:
        for first, second in table.of(verdict):
            ET.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    ET.indent(root, "  ")
    buffer = io.BytesIO()
    ET.ElementTree(root).write(buffer, encoding="utf-8", xml_declaration=True)
    return buffer.getvalue().decode("utf-8") + "\n"


def _where(robot: Mechanism) -> str:
    return "at random where the loops close" if robot.chain.loops else "uniformly from the axis limits"


def write_srdf(robot: Mechanism, table: PairTable, folder: Path | str = "urdf_out") -> Path:
    """Write a robot's SRDF next to its URDF, folder/NAME/NAME.srdf, and return that path.

    Raises:
        FileAccessError: the file cannot be written.
    """
    path = file_of(folder, robot.name, "srdf")
    write_text(path, srdf_text(robot, table))
    return path
