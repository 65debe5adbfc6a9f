"""`chainbuild couple`: a tool motion distributed over the partial kinematics of a coupling."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, Final

from cyclopts import Parameter

from chainbuild.cli.show import console, empty_table, print_json, shown_number
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, UsageError

if TYPE_CHECKING:
    from chainbuild.coupling.distribution import Distribution
    from chainbuild.robot import Robot

OptionWords = Annotated[tuple[str, ...], Parameter(negative="", show_default=False)]
_LETTERS = "XYZABC"
_DIGITS: Final = 9  # of mm and degrees: further ones are noise


def couple(
    file: str,
    /,
    *,
    tcp: OptionWords = (),
    program: OptionWords = (),
    lock: OptionWords = (),
    current: OptionWords = (),
    axes: Annotated[bool, Parameter(negative="")] = False,
    json: Json = False,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Distribute a tool position over the partial kinematics of a coupling, KIN_TYP 210.

    In order of priority, each partial takes as much of the motion as its Cartesian freedoms allow. The table shows six
    Cartesian values per partial; coordinates that the partial cannot move are empty.

    Example: `chainbuild couple robot_xy_unit_kin210 --tcp X=700 --tcp Y=100`

    Args:
        file: A machine file, or the name of a shipped machine.
        tcp: LETTER=VALUE: a coordinate of the tool in the workpiece frame, in mm or degrees; may be repeated.
            Coordinates not named keep their values.
        program: PARTIAL.LETTER=VALUE: a coordinate of a partial programmed directly, mm or degrees; may be repeated.
            An axis of the channel stands for its coordinate: Y_LIN=VALUE.
        lock: PARTIAL.LETTER, or an axis: a coordinate that keeps its value; may be repeated.
        current: PARTIAL.LETTER=VALUE, or AXIS=VALUE: a current coordinate of a partial, mm or degrees; may be repeated.
            Default: 0.
        axes: Also compute the axis values that bring every partial to its Cartesian values.
        json: Print JSON.
        options: Which kinematic.
    """
    robot = options.robot(file)
    found = robot.distribute(
        dict(_pairs("--tcp", tcp)) or None,
        axes=dict(_pairs("--program", program)),
        locked=lock,
        current=_by_partial(robot, _pairs("--current", current)),
    )
    values = [float(value) for value in found.axes()] if axes else None
    if json:
        print_json("couple", _data(robot, found, values))
    else:
        _print(robot, found, values)
    return 0


def _pairs(option: str, words: Iterable[str]) -> list[tuple[str, float]]:
    """Return NAME=VALUE words, or several joined by commas, as pairs."""
    found: list[tuple[str, float]] = []
    for word in (part for text in words for part in text.split(",")):
        name, equals, value = word.partition("=")
        try:
            found.append((name.strip(), float(value)))
        except ValueError:
            equals = ""
        if not (name.strip() and equals):
            raise UsageError(
                f"{option} {word}: expected NAME=VALUE, VALUE a number with a decimal point and without a unit"
            )
        if name.strip().casefold() in [known.casefold() for known, _ in found[:-1]]:
            raise UsageError(f"{option} {word}: expected NAME=VALUE once for each name")
    return found


def _by_partial(robot: Robot, pairs: Iterable[tuple[str, float]]) -> dict[str, dict[str, float]]:
    from chainbuild.coupling.distribution import partial_coordinate

    found: dict[str, dict[str, float]] = {}
    for name, value in pairs:
        if name in _LETTERS:
            raise UsageError(f"--current {name}: expected PARTIAL.LETTER=VALUE or AXIS=VALUE")
        partial, letter = partial_coordinate(robot.chain, name)
        found.setdefault(partial, {})[letter] = value
    return found


def _print(robot: Robot, found: Distribution, values: list[float] | None) -> None:
    shown = empty_table("Distribution (mm, degrees)", "Partial", *_LETTERS)
    for part in found.partials:
        cells = (shown_number(_rounded(v)) if free else "" for v, free in zip(part.values, part.free, strict=True))
        shown.add_row(part.name, *cells)
    shown.add_row("TCP", *(shown_number(_rounded(value)) for value in found.tcp))
    out = console()
    out.print(shown)
    if values is not None:
        listed = empty_table("Axes", *(axis.name for axis in robot.axes))
        listed.add_row(*(shown_number(_rounded(value)) for value in values))
        out.print(listed)


def _data(robot: Robot, found: Distribution, values: list[float] | None) -> dict[str, Any]:
    data: dict[str, Any] = {
        "tcp": {letter: _rounded(value) for letter, value in zip(_LETTERS, found.tcp, strict=True)},
        "partials": {
            part.name: {
                letter: _rounded(value)
                for letter, value, free in zip(_LETTERS, part.values, part.free, strict=True)
                if free
            }
            for part in found.partials
        },
    }
    if values is not None:
        data["axes"] = {axis.name: _rounded(value) for axis, value in zip(robot.axes, values, strict=True)}
    return data


def _rounded(value: float) -> float:
    return round(float(value), _DIGITS) + 0.0
