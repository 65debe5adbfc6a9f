"""Machine data files written from a few words, and poses in mm, by elementary matrices."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from chainbuild.chain.elements import Chain
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.sinumerik.machine import RobxMachine, read_machine
from chainbuild.formats.text import SourceText

Value = float | Sequence[float]
Data = Mapping[str, Value]

KIND = {1: "LLL", 2: "LRR", 3: "RRR", 4: "LLR", 5: "RRL", 6: "RLL", 7: "RRR"}

# A 6-axis articulated arm with every frame of its own, so that nothing hides behind a zero.
NR6: Data = {
    "MAIN_AXES": 3,
    "WRIST_AXES": 2,
    "NUM_AXES": 6,
    "AXES_TYPE": (3, 3, 3, 3, 3, 3),
    "MAIN_LENGTH_AB": (150, 700),
    "TIRORO_POS": (0, 0, 445),
    "TX3P3_POS": (795, 0, 115),
    "TX3P3_RPY": (0, 90, 0),
    "TFLWP_POS": (0, 0, 85),
    "TFLWP_RPY": (0, 0, 0),
}


# The same arm with five axes.
ARM5: Data = {**NR6, "NUM_AXES": 5, "TFLWP_RPY": (30, 0, 0)}

# The worked example of the older package's manual: a 4-axis articulated arm.
TE4_ARM: Data = {
    "KINCLASS": 1,
    "NUM_AXES": 4,
    "MAIN_AXES": 3,
    "WRIST_AXES": 1,
    "A4PAR": 1,
    "AXES_TYPE": (3, 3, 3, 3),
    "MAIN_LENGTH_AB": (300, 300),
    "TIRORO_POS": (0, 0, 500),
    "TX3P3_POS": (300, 0, 0),
    "TX3P3_RPY": (0, 0, -90),
    "TFLWP_POS": (200, 0, 0),
    "TFLWP_RPY": (0, -90, 180),
}

# A SCARA with its first axis linear, signs and zeros given.
CC4: Data = {
    "MAIN_AXES": 2,
    "NUM_AXES": 4,
    "WRIST_AXES": 1,
    "A4PAR": 1,
    "AXES_TYPE": (1, 3, 3, 3, 3, 3),
    "MAIN_LENGTH_AB": (150, 250),
    "TIRORO_RPY": (0, 0, 90),
    "TX3P3_POS": (220, 0, 0),
    "TX3P3_RPY": (0, 0, -90),
    "TFLWP_RPY": (0, -90, 180),
    "AXES_DIR": (1, -1, 1, -1),
    "MAMES": (10, 20, -30, 40),
}

# The six-axis arm before a rotary/swivel table (ROBX manual 8.2.3), and with two axes behind its flange (8.3.3).
TABLE: Data = {
    **NR6,
    "EXT_ROT_AX_VECTOR_1": (0, 0, 1),
    "EXT_ROT_AX_VECTOR_2": (0, 1, 0),
    "EXT_ROT_JOINT_OFFSET_1": (30, 0, 0),
    "EXT_ROT_BASE_OFFSET": (900, 0, 200),
    "EXT_ROT_PART_OFFSET": (0, 0, 40),
}

FLANGE: Data = {
    **NR6,
    "EXT_FL_ROT_AX_VECTOR_1": (0, 0, 1),
    "EXT_FL_ROT_AX_VECTOR_2": (0, 1, 0),
    "EXT_FL_ROT_JOINT_OFF_1": (60, 0, -70),
    "EXT_FL_ROT_BASE_OFFSET": (50, 0, 0),
    "TTCFL_POS": (0, 0, -80),
    "TTCFL_RPY": (0, 90, 0),
}


def robx_text(data: Data, *, axes_in: Sequence[int] | None = None, extra: str = "", package: str = "ROBX") -> str:
    """Return a machine data file; `axes_in` defaults to the robot axes that NUM_AXES names."""
    count = int(data.get("NUM_AXES", 4))  # type: ignore[call-overload]
    inputs = axes_in if axes_in is not None else range(1, count + 1)
    lines = ["CHANDATA(1)", f"N24100 $MC_TRAFO_TYPE_1={4099 if package == 'TRAFO6' else 4100}"]
    lines += [f"N24110 $MC_TRAFO_AXES_IN_1[{n}]={axis}" for n, axis in enumerate(inputs)]
    for name, value in data.items():
        if isinstance(value, (int, float)):
            lines.append(f"$MC_{package}_{name}={value}")
        else:
            lines += [f"$MC_{package}_{name}[{n}]={element}" for n, element in enumerate(value)]
    return "\n".join([*lines, extra, "M17", ""])


def read(text: str, *, overlay: Overlay | None = None, strict: bool = True, file: str = "arm.tea") -> RobxMachine:
    """Read a text as a machine file."""
    return read_machine(SourceText(file, text, "utf-8"), Path(file), overlay or Overlay(), Collector(strict=strict))


def chain_of(data: Data, *, conventions: Mapping[str, str] | None = None, **options: object) -> Chain:
    """Return the chain of data; options as for `robx_text`, and kinematic, overlay."""
    kinematic = options.pop("kinematic", None)
    overlay = options.pop("overlay", None)
    machine = read(robx_text(data, **options), overlay=overlay)  # type: ignore[arg-type]
    return machine.chain(kinematic=kinematic, conventions=conventions)  # type: ignore[arg-type]


def pose_of(chain: Chain, axes: Sequence[float]) -> np.ndarray:
    """Return the tool in the workpiece frame, 4×4 with mm, by elementary matrices and not by Pinocchio."""
    q = chain.axis_map.q(np.asarray(axes, dtype=float))
    links = {"base": np.eye(4)}
    for joint, value in zip(chain.joints, q, strict=True):
        links[joint.child] = links[joint.parent] @ joint.T_parent_joint @ _motion(joint.kind, joint.direction, value)
    tool, workpiece = chain.frame("tool"), chain.frame("workpiece")
    T = np.linalg.inv(links[workpiece.link] @ workpiece.T_link_frame) @ links[tool.link] @ tool.T_link_frame
    T[:3, 3] *= 1000.0
    return T


def _motion(kind: str, direction: np.ndarray, value: float) -> np.ndarray:
    T = np.eye(4)
    if kind == "prismatic":
        T[:3, 3] = value * direction
        return T
    x, y, z = direction
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T[:3, :3] = np.eye(3) + math.sin(value) * K + (1 - math.cos(value)) * K @ K
    return T


def T(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    """Return a translation."""
    result = np.eye(4)
    result[:3, 3] = (x, y, z)
    return result


def R(axis: str, degrees: float) -> np.ndarray:
    """Return a rotation about x, y or z."""
    return _motion("revolute", np.eye(3)["xyz".index(axis)], math.radians(degrees))


def F(position: Sequence[float], rpy: Sequence[float] = (0, 0, 0)) -> np.ndarray:
    """Return a frame of machine data."""
    return T(*position) @ R("z", rpy[0]) @ R("y", rpy[1]) @ R("x", rpy[2])


def close(left: np.ndarray, right: np.ndarray) -> bool:
    """Tell whether two poses agree to 1e-7 mm and 1e-10."""
    return bool(np.abs(left[:3, 3] - right[:3, 3]).max() < 1e-7 and np.abs(left[:3, :3] - right[:3, :3]).max() < 1e-10)
