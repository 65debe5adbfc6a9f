"""Mechanisms in the values that the controller displays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from chainbuild.kinematics.mechanism import Mechanism

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from chainbuild.ik.request import Held
    from chainbuild.ik.result import IkResult
    from chainbuild.ik.search.table import IkTable


class DisplayedMechanism(Mechanism):
    """A mechanism with the way between its axis values and what the controller displays."""

    def display(self, axes: ArrayLike, *, near: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return what the controller displays at axis values (n_axes,): column name → value, mm and degrees.

        The columns are those of pose tables: x_mm, y_mm, z_mm, the rotary axes (RTCP) or pose angles, input axes.

        Args:
            axes: Axis values.
            near: What was displayed before: of two answers for a tool vector the nearer one is taken.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the kinematic has no pose there, or `near` lacks an angle that is needed.
        """
        from chainbuild.kinematics.displayed import displayed

        return displayed(self, axes, near)

    def from_display(
        self, shown: Mapping[str, float], start: ArrayLike | None = None, held: Held | None = None
    ) -> IkResult:
        """Find axis values for what the controller displays, as `display` returns it.

        On RTCP kinematics the rotary axes are given and the linear ones alone are solved for, exactly.

        Args:
            shown: Values of the columns that `display` returns, or a full orientation in the columns of pose tables.
            start: As for `ik`; where the control keeps a side (a hand, the sign of X), it is that of the start.
            held: As for `ik`; input axes in `shown` win, rotary axes cannot be held at other values than those shown.

        Raises:
            ChainbuildError: a column is missing or unknown, or a value is not finite.
        """
        from chainbuild.ik.displayed import from_display

        return from_display(self, shown, start, held)

    def from_display_batch(
        self, shown: Mapping[str, ArrayLike], start: ArrayLike | None = None, *, compiled: bool = True
    ) -> IkTable:
        """Find axis values for many displayed poses; see `from_display`.

        Args:
            shown: Column → (N,) values, or one value for all.
            start: Axis values (n_axes,) for all poses.
            compiled: False: NumPy, even where numba is installed.

        Raises:
            ChainbuildError: a column is missing or unknown, of another length, or a value is not finite.
        """
        from chainbuild.ik.displayed import from_display_batch

        return from_display_batch(self, shown, start, compiled=compiled)
