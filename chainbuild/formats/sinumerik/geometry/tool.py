"""Tool: lengths by plane and tool direction, orientation by $TC_DPC angles or $TC_DPV vectors (ROBX manual 6.1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chainbuild import frames, tolerances
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError, Span
from chainbuild.formats.sinumerik.reading.robx import Robx, Vector3

Matrix = NDArray[np.float64]

# Flange axis along which lengths 1, 2 and 3 act. Only G17 is printed.
_PLANES: Mapping[str, Mapping[int, str]] = {
    "cyclic": {17: "zyx", 18: "yxz", 19: "xzy"},
    "swapped": {17: "zyx", 18: "yzx", 19: "xyz"},
    "as_g17": {17: "zyx", 18: "zyx", 19: "zyx"},
}


@dataclass(frozen=True, slots=True)
class Tool:
    """The active tool.

    Attributes:
        lengths_mm: Lengths 1, 2, 3: $TC_DP3, $TC_DP4, $TC_DP5.
        angles_deg: $TC_DPC1 … $TC_DPC10.
        predefined: $TC_DPV; 0 takes the vector.
        direction: $TC_DPV3 … $TC_DPV5.
        normal: $TC_DPVN3 … $TC_DPVN5.
        plane: 17, 18 or 19.
        name: "T1 D1" where a file gives it, "overlay", or empty for no tool.
        span: Where it is given.
    """

    lengths_mm: Vector3 = (0.0, 0.0, 0.0)
    angles_deg: tuple[float, ...] = (0.0,) * 10
    predefined: int = 0
    direction: Vector3 = (0.0, 0.0, 0.0)
    normal: Vector3 = (0.0, 0.0, 0.0)
    plane: int = 17
    name: str = ""
    span: Span | None = None

    def along_flange(self, components: Vector3, choose: Choices) -> Matrix:
        """Return a vector whose components are counted like lengths 1, 2, 3 in flange axes."""
        axes = _PLANES["as_g17" if self.plane == 17 else choose["tool_length_plane"]][self.plane]
        result = np.zeros(3)
        for component, axis in zip(components, axes, strict=True):
            result["xyz".index(axis)] = component
        return result


def length_transform(robx: Robx, tool: Tool, tool_length_mm: float, choose: Choices) -> Matrix:
    """Return Trans(lengths) along the carrier's axes; TOOL_DIR other than 0 negates them (ROBX manual 6.1.3)."""
    first, second, third = tool.lengths_mm
    sign = 1.0 if robx.tool_dir == 0 else -1.0
    return frames.transform(None, sign * tool.along_flange((first + tool_length_mm, second, third), choose) + 0.0)


def turn_transform(robx: Robx, tool: Tool, choose: Choices) -> Matrix:
    """Return the rotation of the tool about its tip: $TC_DPC angles, $TC_DPV vectors, or none (MD62936)."""
    start = robx.toa_start
    if start > 0:
        a, b, c = tool.angles_deg[start - 1 : start + 2]
        return frames.f_frame((0.0, 0.0, 0.0), (a, b, c))
    return frames.transform(_from_vectors(robx, tool, choose)) if start < 0 else np.eye(4)


def _from_vectors(robx: Robx, tool: Tool, choose: Choices) -> Matrix:
    """Return the rotation whose tool axis is $TC_DPV and whose normal axis is $TC_DPVN."""
    if tool.predefined:
        raise MachineDataError(
            f"$TC_DPV = {tool.predefined} asks for a predefined direction that the ROBX manual does not describe",
            span=tool.span,
            parameter="$TC_DPV",
            permitted="0, with the vector in $TC_DPV3 to $TC_DPV5",
            code="CB336",
        )
    vector = tool.along_flange(tool.direction, choose)
    if np.linalg.norm(vector) < tolerances.ZERO_VECTOR:
        return np.eye(3)
    forward = frames.unit(vector)
    along_z = robx.tool_dir == 1
    normal = tool.along_flange(tool.normal, choose)
    across = normal - forward * (normal @ forward)
    if np.linalg.norm(across) <= tolerances.UNIT_VECTOR * max(float(np.linalg.norm(normal)), tolerances.ZERO_VECTOR):
        return _smallest_turn(np.array([0.0, 0.0, 1.0] if along_z else [1.0, 0.0, 0.0]), forward)
    n = frames.unit(across)
    third = np.cross(forward, n)
    if choose["dpvn_axis"] == "y":
        columns = (-third, n, forward) if along_z else (forward, n, third)
    else:
        columns = (n, third, forward) if along_z else (forward, -third, n)
    return np.column_stack(columns)


def _smallest_turn(start: Matrix, end: Matrix) -> Matrix:
    """Return the smallest rotation from one unit vector to another; for opposite ones half a turn about Y."""
    axis = np.cross(start, end)
    sine, cosine = float(np.linalg.norm(axis)), float(start @ end)
    if sine < tolerances.ZERO_VECTOR:
        return np.eye(3) if cosine > 0 else frames.rot_y(180.0)
    return frames.rot_about(axis, float(np.degrees(np.arctan2(sine, cosine))))
