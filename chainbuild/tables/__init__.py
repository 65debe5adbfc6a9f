"""CSV tables of axis values and poses, read and written row by row in constant memory.

Comma, decimal point, one header line, columns by name in any order; lengths in mm and angles in degrees with 12
decimals, unit vectors with 15, which is all that double precision keeps of a machine. Other separators and marks are
read (`sheet`), not written. The orientation is what the controller displays (`form`): on RTCP kinematics the rotary
axes, else pose angles; a full orientation may replace it.

In reading order: `sheet`, `reader`, `axes`, `form`, `poses`, `recording`.
"""

from __future__ import annotations

from chainbuild.tables.axes import AxisTable, IkWriter
from chainbuild.tables.form import PoseForm
from chainbuild.tables.poses import PoseRow, PoseTable, PoseWriter

__all__ = ["AxisTable", "IkWriter", "PoseForm", "PoseRow", "PoseTable", "PoseWriter"]
