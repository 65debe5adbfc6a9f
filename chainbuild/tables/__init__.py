"""CSV tables of axis values and poses, read and written row by row in constant memory.

Comma, decimal point, one header line, columns by name in any order; lengths in mm and angles in degrees with 12
decimals, unit vectors with 15, which is all that double precision keeps of a machine. An orientation is read from a
quaternion, else from the angles A, B, C of the controller, else, for machines that cannot turn about the tool vector,
from the tool vector alone.

In reading order: `columns`, `reader`, `axes`, `poses`, `recording`.
"""

from __future__ import annotations

from chainbuild.tables.axes import AxisTable, IkWriter
from chainbuild.tables.poses import POSE_COLUMNS, PoseRow, PoseTable, PoseWriter

__all__ = ["POSE_COLUMNS", "AxisTable", "IkWriter", "PoseRow", "PoseTable", "PoseWriter"]
