"""SRDF: pairs of links that need no collision check, passive joints and named poses, for MoveIt and other readers."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.chain.followers import followers
from chainbuild.files import angle_text, file_of, number_text, write_text, xml_text

if TYPE_CHECKING:
    from chainbuild.analysis.collision.pairs import PairTable, Verdict
    from chainbuild.kinematics.mechanism import Mechanism

_GROUP: Final = "axes"
_REASONS: Final[tuple[tuple[Verdict, str], ...]] = (("adjacent", "Adjacent"), ("always", "Always"), ("never", "Never"))


def srdf_text(robot: Mechanism, table: PairTable) -> str:
    """Return the SRDF of a robot: pairs that need no check, joints of loops that no axis drives, named poses.

    A named pose stands there where the kinematic can take it, as joint values of the URDF.
    """
    root = ET.Element("robot", name=robot.name)
    root.append(
        ET.Comment(
            f" Pairs by {table.samples} positions drawn {_where(robot)}. With {table.confidence:.0%} "
            f"confidence a pair listed as Never touches at less than {table.bound:.2g} of all positions. "
        )
    )
    _add_poses(root, robot)
    axes = {axis.name for axis in robot.axes}
    for joint in robot.chain.joints if robot.chain.loops else ():
        if joint.name not in axes:
            ET.SubElement(root, "passive_joint", name=joint.name)
    for verdict, reason in _REASONS:
        for first, second in table.of(verdict):
            ET.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    return xml_text(root)


def _add_poses(root: ET.Element, robot: Mechanism) -> None:
    """Write the named poses as states of one group, which has every joint that no other one drives."""
    chain = robot.chain
    states = [(pose.name, chain.axis_map.q(np.array(pose.axes))) for pose in chain.named_poses]
    states = [(name, q) for name, q in states if np.isfinite(q).all()]
    if not states:
        return
    masters = followers(chain)
    free = [n for n, joint in enumerate(chain.joints) if joint.name not in masters]
    group = ET.SubElement(root, "group", name=_GROUP)
    for n in free:
        ET.SubElement(group, "joint", name=chain.joints[n].name)
    for name, q in states:
        state = ET.SubElement(root, "group_state", name=name, group=_GROUP)
        for n in free:
            write = angle_text if chain.joints[n].kind == "revolute" else number_text
            ET.SubElement(state, "joint", name=chain.joints[n].name, value=write(float(q[n])))


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
