"""Parameters of an ortho-parallel arm with a spherical wrist, in the YAML that solvers of these arms read."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.files import angle_text, number_text, printable
from chainbuild.frames import inverse, translation
from chainbuild.writers.models.robotfiles import rpy_texts, yaml_number

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

_VERSION: Final = 1  # of the block; readers refuse others
_ON_AXIS: Final = 1e-9  # m: a flange this close to the sixth axis lies on it


def opw_text(robot: Mechanism) -> str | None:
    """Return the parameters of a robot as YAML, or None where it is no ortho-parallel arm of six joints.

    Angles from the zero pose are sign · joint value - offset, the joint values those of the URDF.
    """
    from chainbuild.ik.branches.core.query import BranchQuery
    from chainbuild.ik.branches.opw.parameters import opw_arm
    from chainbuild.ik.request import IkRequest

    if len(robot.chain.joints) != 6 or any(joint.kind != "revolute" for joint in robot.chain.joints):
        return None
    serial = BranchQuery.of(IkRequest(robot, np.eye(4))).serial()
    arm = opw_arm(serial)
    if arm is None or len(serial.screws) != 6:
        return None
    flange = _flange(robot, arm.T_flange_tool)
    lengths = {**arm.parameters, "c4": flange}
    tool = translation(z=-flange) @ arm.T_flange_tool
    offsets = [_half_turn(-float(offset)) for offset in arm.offsets]
    joints = [robot.chain.joints[screw.joint].name for screw in serial.screws]
    title = printable(robot.chain.title, lines=False)
    lines = [
        f"# {title}: {robot.chain.kinematic} ({robot.chain.dialect}), written by chainbuild.",
        "# Metres and radians; angle from the upright zero pose = sign * joint value of the URDF - offset.",
        "opw_kinematics_geometric_parameters:",
        *(f"  {name}: {_decimal(number_text(value))}" for name, value in lengths.items()),
        f"opw_kinematics_joint_offsets: [{', '.join(_decimal(angle_text(offset)) for offset in offsets)}]",
        f"opw_kinematics_joint_sign_corrections: [{', '.join(str(int(sign)) for sign in arm.signs)}]",
        "chainbuild:",
        f"  version: {_VERSION}",
        f"  joints: {json.dumps(joints, ensure_ascii=False)}",
        f"  base: {_placement(arm.T_base_arm)}  # of the arm in the frame workpiece",
        f"  tool: {_placement(tool)}  # frame tool in the arm's flange",
    ]
    return "\n".join(lines) + "\n"


def _flange(robot: Mechanism, T_wrist_tool: Matrix) -> float:
    """Return how far the flange lies beyond the wrist centre on the sixth axis [m]; 0 where it does not lie there."""
    flange, tool = robot.chain.frame("flange"), robot.chain.frame("tool")
    if flange.link != tool.link:
        return 0.0
    T = T_wrist_tool @ inverse(tool.T_link_frame) @ flange.T_link_frame
    x, y, z = T[:3, 3].tolist()
    return z if max(abs(x), abs(y)) < _ON_AXIS else 0.0


def _placement(T: Matrix) -> str:
    xyz = ", ".join(_decimal(number_text(value)) for value in T[:3, 3].tolist())
    rpy = ", ".join(_decimal(text) for text in rpy_texts(T))
    return f"{{xyz: [{xyz}], rpy: [{rpy}]}}"


def _half_turn(angle: float) -> float:
    """Return an angle within half a turn; half a turn itself positive."""
    turned = math.remainder(angle, math.tau)
    return math.pi if abs(abs(turned) - math.pi) < _ON_AXIS else turned + 0.0


def _decimal(text: str) -> str:
    """Return a number with a decimal point: readers of YAML tell whole numbers from others."""
    return yaml_number(text) if set(text) & set(".e") else f"{text}.0"
