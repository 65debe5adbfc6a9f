"""Tables of axis values: columns named like the controller's axes, mm and degrees."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final, TextIO

import numpy as np
from numpy.typing import NDArray

from chainbuild.chain.elements import Axis
from chainbuild.chain.programmed.display import POSITION_COLUMNS
from chainbuild.errors import Span, TableError
from chainbuild.tables.reader import Chunk, Table

STATUS_COLUMN: Final = "status"
RESULT_COLUMNS: Final = (STATUS_COLUMN, "position_error_mm", "rotation_error_deg")
VIOLATIONS_COLUMN: Final = "violations"

# Decimals written of mm and degrees, whose last bits are noise, and of unit vectors.
DECIMALS: Final = 12
UNIT_DECIMALS: Final = 15

_POSES: Final = "this is a table of poses: --poses reads it (ik, singularity)"


class AxisTable(Table):
    """A table of axis values; one column an axis, in any order, by any of the axis' names.

    The result columns that inverse kinematics writes are permitted and not read.

    Args:
        path: The file.
        axes: The machine's axes; `Chunk.values` is (n, n_axes) in their order.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: the header is missing, or names a column that is unknown or duplicate, or is incomplete.
    """

    def __init__(self, path: Path, axes: Sequence[Axis]) -> None:
        names = tuple(axis.name for axis in axes)
        self._axis_names = names
        super().__init__(path, lambda _: (names, (*names, *RESULT_COLUMNS, VIOLATIONS_COLUMN)), axes)

    def _shown_columns(self, permitted: Sequence[str]) -> Sequence[str]:
        # Result columns of inverse kinematics are permitted, but never required.
        return self._axis_names

    def _hint(self, name: str) -> str | None:
        return _POSES if set(self.names) >= set(POSITION_COLUMNS) else None

    def _refuse_faults(self, span: Span, fields: Sequence[str]) -> None:
        """Refuse a row that holds no numbers; where inverse kinematics has failed, the message says so."""
        status = fields[self.names.index(STATUS_COLUMN)].strip() if STATUS_COLUMN in self.names else ""
        if status not in ("", "ok") and not any(fields[place].strip() for place in self._places):
            text = f"the row has no axis values: inverse kinematics failed there ({status[:40]})"
            raise TableError(text, span=span, permitted="rows with axis values", hint="remove the failed rows first")
        super()._refuse_faults(span, fields)

    def rows(self) -> Iterator[tuple[int, NDArray[np.float64]]]:
        """Read the rows that are left: line number and axis values (n_axes,)."""
        for chunk in self.chunks():
            yield from zip(chunk.lines, chunk.values, strict=True)


class IkWriter:
    """Writes axis values with the status and errors of inverse kinematics.

    Args:
        stream: Where to.
        axes: The machine's axes, in the order of the columns.
        violations: True: one more column names the limits that are violated.
    """

    def __init__(self, stream: TextIO, axes: Sequence[Axis], *, violations: bool = False) -> None:
        self._stream = stream
        self._empty = "," * max(len(axes) - 1, 0)
        self._violations = violations
        last = (VIOLATIONS_COLUMN,) if violations else ()
        stream.write(",".join([*(axis.name for axis in axes), *RESULT_COLUMNS, *last]) + "\n")

    def write(
        self,
        axes: NDArray[np.float64] | None,
        status: str,
        position_error_mm: float,
        rotation_error_deg: float | None,
        violated: Sequence[str] = (),
    ) -> None:
        """Write one row.

        Args:
            axes: (n_axes,) axis values; None for a failed row, whose axes stay empty.
            status: "ok", "unreachable", "limits" or "stalled".
            position_error_mm: Distance to the pose.
            rotation_error_deg: Angle to it; None where the table gave no orientation.
            violated: Names of the limits that keep the pose out of reach.
        """
        shown = self._empty if axes is None else number_fields(axes.tolist())
        angle = "" if rotation_error_deg is None else number_field(rotation_error_deg)
        last = f",{names_field(violated)}" if self._violations else ""
        self._stream.write(f"{shown},{status},{number_field(position_error_mm)},{angle}{last}\n")


def names_field(names: Sequence[str]) -> str:
    """Return the field that holds several names."""
    return "; ".join(names)


def number_field(value: float, decimals: int = DECIMALS) -> str:
    """Return a number without the noise of its last bits and without signed zero.

    >>> number_field(1765.0000000000002), number_field(-2.3e-14), number_field(0.1 + 0.2)
    ('1765.0', '0.0', '0.3')
    """
    return repr(round(float(value), decimals) + 0.0)


def number_fields(values: Iterable[float]) -> str:
    """Return the fields of lengths in mm and angles in degrees."""
    return ",".join(map(number_field, values))


__all__ = [
    "DECIMALS",
    "RESULT_COLUMNS",
    "UNIT_DECIMALS",
    "VIOLATIONS_COLUMN",
    "AxisTable",
    "Chunk",
    "IkWriter",
    "names_field",
    "number_field",
    "number_fields",
]
