"""SRDF: pairs of links that need no collision check, passive joints and named poses, for MoveIt and other readers."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.chain.followers import followers
from chainbuild.files import angle_text, number_text, xml_text
from chainbuild.writers.models.loops import driven_joints
from chainbuild.writers.models.robotfiles import check_robot, write_robot_files

if TYPE_CHECKING:
    from chainbuild.analysis.collision.pairs import PairTable, Verdict
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.progress import Progress

_GROUP: Final = "axes"
SRDF_SAMPLES: Final = 10_000  # bounds what was missed at 3e-4 of all positions, with 95 % confidence
_MISSED: Final = "with {confidence:.0%} confidence {pair} at less than {bound:.2g} of all positions"
_REASONS: Final[tuple[tuple[Verdict, str, str], ...]] = (
    ("adjacent", "Adjacent", "a joint connects them"),
    ("always", "Always", "they touched at all {samples} positions, and " + _MISSED.replace("{pair}", "are apart")),
    ("never", "Never", "they touched at none of {samples} positions, and " + _MISSED.replace("{pair}", "touch")),
)


def write_srdf(robot: Mechanism, folder: Path | str = "urdf_out", *, samples: int = SRDF_SAMPLES) -> Path:
    """Write a robot's SRDF next to its URDF, folder/NAME/NAME.srdf, and return that path.

    Args:
        robot: The robot.
        folder: Folder in which the folder NAME is created.
        samples: Number of random positions by which pairs of links are judged.

    Raises:
        ChainbuildError: the argument is not a robot, or samples below 1.
        FileAccessError: the folder is not a path, or the file cannot be written.
    """
    check_robot(robot)
    name = f"{robot.name}.srdf"
    return write_robot_files(robot, folder, {name: srdf_text(robot, pair_table(robot, samples))})[name]


def pair_table(robot: Mechanism, samples: int = SRDF_SAMPLES, *, progress: Progress = False) -> PairTable:
    """Return which pairs of links touch never, sometimes or always at random positions.

    Raises:
        ChainbuildError: samples below 1.
    """
    from chainbuild.analysis.collision.pairs import classify_pairs

    return classify_pairs(robot, samples, progress=progress)


def srdf_text(robot: Mechanism, table: PairTable) -> str:
    """Return the SRDF of a robot: pairs that need no check, joints of loops that no axis drives, named poses.

    A named pose stands there where the kinematic can take it, as joint values of the URDF.
    """
    root = ET.Element("robot", name=robot.name)
    root.append(ET.Comment(f" Pairs by {table.samples} positions drawn {_where(robot)}. "))
    _add_poses(root, robot)
    for name in driven_joints(robot.chain)[1]:
        ET.SubElement(root, "passive_joint", name=name)
    for verdict, reason, text in _REASONS:
        pairs = table.of(verdict)
        if pairs:
            said = text.format(samples=table.samples, confidence=table.confidence, bound=table.bound)
            root.append(ET.Comment(f" {reason}: {said}. "))
        for first, second in pairs:
            ET.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    return xml_text(root)


def _add_poses(root: ET.Element, robot: Mechanism) -> None:
    """Write one group, which has every joint that no other one drives, and the named poses as its states.

    By the link `tool` its fixed joint belongs to the group, too: what plans with the group takes it for the tip.
    """
    chain = robot.chain
    states = [(pose.name, chain.axis_map.q(np.array(pose.axes))) for pose in chain.named_poses]
    states = [(name, q) for name, q in states if np.isfinite(q).all()]
    masters = followers(chain)
    free = [n for n, joint in enumerate(chain.joints) if joint.name not in masters]
    group = ET.SubElement(root, "group", name=_GROUP)
    for n in free:
        ET.SubElement(group, "joint", name=chain.joints[n].name)
    ET.SubElement(group, "link", name="tool")
    for name, q in states:
        state = ET.SubElement(root, "group_state", name=name, group=_GROUP)
        for n in free:
            write = angle_text if chain.joints[n].kind == "revolute" else number_text
            ET.SubElement(state, "joint", name=chain.joints[n].name, value=write(float(q[n])))


def _where(robot: Mechanism) -> str:
    return "at random where the loops close" if robot.chain.loops else "uniformly from the axis limits"
