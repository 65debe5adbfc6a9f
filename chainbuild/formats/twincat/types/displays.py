"""What the control shows and takes as a pose of each type beside the position (KIN_TYP manual 1, 1.4, 4.1).

RTCP types are programmed by position and their own rotary axes, complete ones by position and angles; a type that
departs from that has a table `[display]` in its data.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from chainbuild.chain.elements import Axis
from chainbuild.chain.programmed.display import POSE_ANGLES, Display
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.recipe import Params

# Angle modes of two letters: the third angle is not programmed.
_TWO_LETTERS: Final = {"ab": ("a_deg", "b_deg"), "ba": ("a_deg", "b_deg")}


def display_of(params: Params, axes: Sequence[Axis], angle_mode: str, choose: Choices) -> Display:
    """Return the display of a type of the catalogue.

    Args:
        params: The type's data and head offsets.
        axes: The axes of its chain.
        angle_mode: Name in `frames.ANGLE_MODES` of the channel.
        choose: Conventions.
    """
    data = params.data
    rtcp = data.orientation == "rtcp"
    if data.number == 207 and choose["kin207_programmed_point"] == "slid_xyz":
        return replace(by_rotary_axes(axes), solved=(0, 1))  # the point is on the plane z = HD11 whatever Z is
    if not data.display:
        return by_rotary_axes(axes) if rtcp else by_angles(angle_mode)
    return _chosen(_from_table(data.display, axes, rtcp), params, choose)


def _chosen(display: Display, params: Params, choose: Choices) -> Display:
    """Return the display of a type by the conventions on it."""
    number = params.data.number
    if number == 36 and choose["kin36_c"] == "absolute":
        return replace(display, kind="plane", columns=("c_deg",), axes=(), solved=(), along="x")
    if number == 202 and params.flag("right_variant"):
        turned = choose["kin202_right_frame"] == "turned_180"
        aside = not turned and choose["kin202_c"] == "from_zero"
        return replace(display, zero_deg=180.0 if aside else 0.0)
    if number == 213 and choose["kin213_angles"] == "pitch_and_turn":
        return replace(display, kind="pitch")
    if number == 208 and choose["kin208_angles"] == "pose_angles":
        return Display("angles", tuple(sorted(display.columns)), follows=True)
    return display


def by_rotary_axes(axes: Sequence[Axis]) -> Display:
    """Return the display of RTCP types: the rotary axes by name, the linear ones solved for."""
    rotary = tuple(n for n, axis in enumerate(axes) if axis.kind == "rotary")
    linear = tuple(n for n, axis in enumerate(axes) if axis.kind == "linear")
    return Display("axes", (), rotary, linear, rtcp=True)


def by_angles(angle_mode: str) -> Display:
    """Return the display of complete types: the angles of P-CHAN-00112, of modes 14 and 15 their two letters."""
    return replace(POSE_ANGLES, columns=_TWO_LETTERS.get(angle_mode, POSE_ANGLES.columns))


def _from_table(table: Mapping[str, Any], axes: Sequence[Axis], rtcp: bool) -> Display:
    names = [axis.name for axis in axes]
    given = {**table, "columns": tuple(table.get("columns", ()))}
    if table["kind"] == "axes":
        rotary = by_rotary_axes(axes)
        solved = tuple(names.index(name) for name in table["solved"]) if "solved" in table else rotary.solved
        shown = tuple(n for n, axis in enumerate(axes) if axis.kind == "rotary" and n not in solved)
        given |= {"axes": shown, "solved": solved}
    return Display(**given, rtcp=rtcp)
