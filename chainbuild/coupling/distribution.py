"""Distribution of a tool motion over the partial kinematics of a composed robot, in Cartesian coordinates.

In order of rank, each partial takes as much of the motion as its Cartesian freedoms allow and passes on the rest: first
its angles, so that as little rotation as possible remains, then its position, the nearest that its linear freedoms
reach. Coordinates that are programmed directly, and locked ones, keep their values. Others start at 0: the distribution
depends on the target alone, not on the current values. Workspace limits are not checked; the axes of each partial are a
second step (Couple kinematics 3.4, 4.1 to 4.4).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Chain, Partial
from chainbuild.chain.names import axis_index
from chainbuild.chain.poses import rotation_vector
from chainbuild.coupling.partial_state import LETTERS, TURNS, State, as_transform
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.html import html_table
from chainbuild.ik.solve import solve
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import number, two_lines
from chainbuild.units import mm_from_m

_PASSES: Final = 50  # rounds over the partials; one is enough unless one moves what another has placed
_DONE: Final = 1e-12  # m and rad
_NEGLIGIBLE: Final = 1e-9  # m and rad: rounding of the product over all partials

PoseValues = Mapping[str, float] | Sequence[float]


@dataclass(frozen=True, slots=True, eq=False)
class PartialPose:
    """Target of a partial.

    Attributes:
        name: The partial's name.
        values: (6,) X, Y, Z [mm], A, B, C [degrees] of its tool frame in its own coordinate system.
        free: Which of the six it can move by itself.
        T: (4, 4) the same as a transform [m].
    """

    name: str
    values: Vector
    free: tuple[bool, ...]
    T: Matrix

    def __repr__(self) -> str:
        return two_lines(f"<PartialPose {self.name}: {_shown(self.values)} [mm, deg]>")


@dataclass(frozen=True, slots=True, eq=False)
class Distribution:
    """A distributed motion.

    Attributes:
        tcp: (6,) X, Y, Z [mm], A, B, C [degrees] of the tool in the workpiece frame.
        partials: Target of each partial, in the order of the axes.
        robot: The composed robot.
    """

    tcp: Vector
    partials: tuple[PartialPose, ...]
    robot: Mechanism

    def __repr__(self) -> str:
        names = ", ".join(part.name for part in self.partials)
        return two_lines(f"<Distribution of {_shown(self.tcp)} [mm, deg] over {names}; .partials, .axes()>")

    def _repr_html_(self) -> str:
        head = ("", *(f"{letter} [{'mm' if n < 3 else 'deg'}]" for n, letter in enumerate(LETTERS)))
        rows = [(part.name, *(number(float(value)) for value in part.values)) for part in self.partials]
        return html_table(head, [("tool", *(number(float(value)) for value in self.tcp)), *rows])

    def axes(self, start: ArrayLike | None = None) -> Vector:
        """Return the axis values (n_axes,) of the composed robot: the second step, partial by partial.

        Args:
            start: Axis values to start from; None: each partial's own default.

        Raises:
            ChainbuildError: a partial cannot reach its target; the message gives its name and the reason.
        """
        found = np.zeros(len(self.robot.axes))
        begin = None if start is None else self.robot.axis_values(start)
        for partial, part in zip(_partials(self.robot.chain), self.partials, strict=True):
            own = slice(partial.first_axis, partial.first_axis + len(partial.chain.axes))
            result = solve(Mechanism(partial.chain), part.T, None if begin is None else begin[own])
            if not result.success:
                text = f"{part.name} cannot reach {_shown(part.values)}: {result.status}"
                raise ChainbuildError(f"{text}, {result.reason}" if result.reason else text, parameter=part.name)
            found[own] = result.axes
        return found


def distribute(
    robot: Mechanism,
    tcp: PoseValues | None = None,
    *,
    axes: Mapping[str, float | Mapping[str, float]] | None = None,
    locked: Iterable[str] = (),
    current: Mapping[str, PoseValues] | None = None,
) -> Distribution:
    """Distribute a tool position over the partials of a robot.

    Args:
        robot: A composed robot.
        tcp: X, Y, Z [mm], A, B, C [degrees] of the tool in the workpiece frame, all six or some by letter; letters
            not named keep their values at `current`, even if `axes` moves the workpiece. None: the partials keep
            their values, and the tool follows them.
        axes: Directly programmed coordinates: "PARTIAL.X" or the axis that stands for it ("Y_LIN") → value, or
            PARTIAL → letter → value.
        locked: Coordinates that keep their values: "PARTIAL.X" or an axis; in addition to those that the chain locks.
        current: PARTIAL → its current values, all six or some by letter; the others are 0.

    Raises:
        AxisValueError: an unknown partial or letter, a freedom that a partial does not have, or not a finite number.
        ChainbuildError: the free coordinates cannot make the motion; the message gives the residual.
    """
    states = [State.of(partial) for partial in _partials(robot.chain)]
    by_name = {state.partial.name: state for state in states}
    for name, values in (current or {}).items():
        state = _find(by_name, name)
        own = {state.coordinate(c): v for c, v in values.items()} if isinstance(values, Mapping) else values
        for letter, value in _six(own).items():
            state.now[LETTERS.index(letter)] = value
    split = _Split(robot.chain, states)
    before = split.tcp()
    for name, letter, value in _programmed(robot.chain, axes or {}):
        _find(by_name, name).program(letter, value)
    for name, letter in (partial_coordinate(robot.chain, text) for text in locked):
        _find(by_name, name).hold(letter)
    if tcp is None:
        return split.result(robot)
    target = before
    for letter, value in _six(tcp).items():
        target[LETTERS.index(letter)] = value
    split.run(target)
    return split.result(robot, target)


@dataclass(slots=True, eq=False)
class _Split:
    """A motion while it is distributed."""

    chain: Chain
    states: list[State]

    @property
    def tool_side(self) -> list[State]:
        return [state for state in self.states if state.partial.group == 0]

    def workpiece(self) -> Matrix:
        """Return the workpiece frame in the coordinate system of the group that carries the tool [m]."""
        T = np.eye(4)
        for state in self.states:
            first = state.partial.first_axis
            own = self.chain.axes[first : first + len(state.partial.chain.axes)]
            if state.partial.group > 0 and all(axis.carries == "workpiece" for axis in own):
                T = T @ state.T_below
        return T

    def pose(self) -> Matrix:
        """Return the tool in the workpiece frame [m]."""
        return frames.inverse(self.workpiece()) @ _product(self.tool_side)

    def tcp(self) -> Vector:
        return _values(self.chain.angle_mode, self.pose())

    def run(self, target: Vector) -> None:
        """Bring the tool to six values."""
        for state in self.tool_side:
            for letter in state.freedoms.letters:
                if letter not in state.held:
                    state.now[LETTERS.index(letter)] = 0.0
        T = self.workpiece() @ as_transform(self.chain.angle_mode, target)
        states = self.tool_side
        ranks = [n if state.partial.rank is None else state.partial.rank for n, state in enumerate(states)]
        order = sorted(range(len(states)), key=lambda n: ranks[n])
        # A rotating partial may move what an earlier one has placed; then another round follows.
        for _ in range(_PASSES):
            for n in order:
                self._assign(states, n, T, target)
            if self._remaining(T) < _DONE:
                return
        if self._remaining(T) > _NEGLIGIBLE:
            raise self._refusal(T)

    def _assign(self, states: Sequence[State], n: int, T: Matrix, target: Vector) -> None:
        state, mode = states[n], states[n].partial.chain.angle_mode
        before = _product(states[:n]) @ state.partial.T_carrier_mcs
        after = _product(states[n + 1 :])
        R = before[:3, :3].T @ T[:3, :3] @ after[:3, :3].T
        same = mode == self.chain.angle_mode and np.array_equal(
            R, frames.matrix_from_angles(mode, target[TURNS].tolist())
        )
        state.turn(R, target[TURNS] if same else None)
        T_own = state.T
        position = before[:3, :3].T @ (T[:3, 3] - before[:3, 3]) - T_own[:3, :3] @ after[:3, 3]
        state.shift(np.array([mm_from_m(float(value)) for value in position]))

    def _remaining(self, T: Matrix) -> float:
        left = frames.inverse(_product(self.tool_side)) @ T
        return max(float(np.linalg.norm(left[:3, 3])), float(np.linalg.norm(rotation_vector(left[:3, :3]))))

    def _refusal(self, T: Matrix) -> ChainbuildError:
        left = frames.inverse(_product(self.tool_side)) @ T
        distance, angle = np.linalg.norm(left[:3, 3]) * 1e3, np.degrees(np.linalg.norm(rotation_vector(left[:3, :3])))
        free = "; ".join(
            f"{s.partial.name}: {' '.join(c for c in s.freedoms.letters if c not in s.held) or 'none'}"
            for s in self.tool_side
        )
        return ChainbuildError(
            f"the partials cannot make the motion: {distance:.6g} mm and {angle:.6g} deg are left over",
            parameter="tcp", permitted=f"what the free coordinates reach ({free})",
        )  # fmt: skip

    def result(self, robot: Mechanism, target: Vector | None = None) -> Distribution:
        parts = tuple(
            PartialPose(
                state.partial.name,
                state.now + 0.0,
                tuple(letter in state.freedoms.letters for letter in LETTERS),
                state.T,
            )
            for state in self.states
        )
        return Distribution(self.tcp() if target is None else target, parts, robot)


def _partials(chain: Chain) -> tuple[Partial, ...]:
    return chain.partials or (Partial(chain.name, chain, np.eye(4), 0),)


def _product(states: Iterable[State]) -> Matrix:
    T = np.eye(4)
    for state in states:
        T = T @ state.T_below
    return T


def _values(mode: str, T: Matrix) -> Vector:
    return np.array([*(mm_from_m(float(v)) for v in T[:3, 3]), *frames.angles_from_matrix(mode, T[:3, :3])])


def _six(values: PoseValues) -> dict[str, float]:
    """Return checked values by letter."""
    pairs = dict(values) if isinstance(values, Mapping) else dict(zip(LETTERS, values, strict=False))
    if not isinstance(values, Mapping) and len(values) != len(LETTERS):
        raise AxisValueError(
            f"expected 6 values, got {len(values)}", permitted="six: X, Y, Z in mm, A, B, C in degrees"
        )
    for letter, value in pairs.items():
        if letter not in LETTERS:
            raise AxisValueError(f"there is no coordinate {letter}", permitted=", ".join(LETTERS))
        _number(letter, value)
    return {letter: float(value) for letter, value in pairs.items()}


def _programmed(chain: Chain, axes: Mapping[str, float | Mapping[str, float]]) -> Iterable[tuple[str, str, float]]:
    for key, value in axes.items():
        if isinstance(value, Mapping):
            yield from ((key, letter, _number(f"{key}.{letter}", one)) for letter, one in value.items())
        else:
            name, letter = partial_coordinate(chain, key)
            yield name, letter, _number(key, value)


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < tolerances.HUGE_AXIS_VALUE:
        raise AxisValueError(f"{name} has the value {value!r}", parameter=name, permitted="a finite number")
    return float(value)


def partial_coordinate(chain: Chain, text: str) -> tuple[str, str]:
    """Return the partial and the coordinate that "PARTIAL.X" means, or the axis of a partial given by its name.

    A letter alone is none: it is a coordinate of the tool.

    Raises:
        AxisValueError: it means neither.
    """
    name, dot, letter = text.rpartition(".")
    if dot and name and letter:
        return name, letter
    n = None if text in LETTERS else axis_index(chain.axes, text)
    if n is None:
        named = [axis.name for axis in chain.axes if axis.generic]
        permitted = f"PARTIAL.LETTER, such as ROBOT.X{''.join(f', {name}' for name in named)}"
        raise AxisValueError(f"{text} is not a coordinate of a partial", permitted=permitted)
    partial = next(p for p in reversed(_partials(chain)) if p.first_axis <= n)
    return partial.name, partial.chain.axes[n - partial.first_axis].name


def _find(states: Mapping[str, State], name: str) -> State:
    if name not in states:
        raise AxisValueError(f"there is no partial {name}", parameter=name, permitted=", ".join(states))
    return states[name]


def _shown(values: Vector) -> str:
    return " ".join(f"{letter}{number(float(value))}" for letter, value in zip(LETTERS, values, strict=True))
