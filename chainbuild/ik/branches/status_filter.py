"""The branches of one pose status and turn: IS and IT of a program (KIN_TYP manual 3.3.3)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from chainbuild.arrays import Vector
from chainbuild.chain.programmed.status import HAND_AXIS, HAND_NEGATIVE, check_status_turn
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.status_turn import require_status, status_turn
from chainbuild.kinematics.mechanism import Mechanism


@dataclass(frozen=True, slots=True, eq=False)
class StatusFilter:
    """Solutions of one status and turn.

    Attributes:
        mechanism: The robot.
        status: Its pose status.
        turn: Which axes are below zero; None: any.
    """

    mechanism: Mechanism
    status: int
    turn: int | None

    @classmethod
    def of(cls, mechanism: Mechanism, status: object, turn: object) -> StatusFilter:
        """Return the filter of a status and a turn.

        Raises:
            ChainbuildError: the kinematic has no status, one of them is no integer or out of range, the turn is given
                without the status, or they contradict each other.
        """
        require_status(mechanism)
        return cls(mechanism, *check_status_turn(status, turn))

    @property
    def words(self) -> str:
        """Status and turn, as text."""
        return f"status {self.status}" if self.turn is None else f"status {self.status} with turn {self.turn}"

    def keeps(self, axes: Vector) -> bool:
        """Return whether axis values (6,) have this status and turn."""
        status, turn = status_turn(self.mechanism, axes)
        return status == self.status and self.turn in {None, turn}

    def applied(self, query: BranchQuery) -> BranchQuery:
        """Return a query for the solutions of this status and turn; whole turns of an axis may change both."""
        below_zero = {HAND_AXIS: bool(self.status & HAND_NEGATIVE)}
        if self.turn is not None:
            below_zero = {n: bool(self.turn >> n & 1) for n in range(len(self.mechanism.axes))}
        return replace(query, below_zero=below_zero, keeps=self.keeps)
