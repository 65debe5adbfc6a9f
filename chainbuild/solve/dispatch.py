"""Which solver answers: the damped one, a closed form, the controller's budget, or what fits best."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, get_args

from numpy.typing import ArrayLike

from chainbuild.errors import ChainbuildError
from chainbuild.solve.analytic import method_of, solve_analytic
from chainbuild.solve.controller import budget_of, solve_controller
from chainbuild.solve.damped import solve
from chainbuild.solve.result import IkResult
from chainbuild.solve.start import Held

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.robot.robot import Robot

Solver = Literal["auto", "damped", "analytic", "controller"]
SOLVERS: Final[tuple[str, ...]] = get_args(Solver)


def solve_by(
    robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, solver: str = "auto"
) -> IkResult:
    """Return axis values for a pose by the solver asked for.

    Args:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        start: See `Robot.ik`.
        held: See `Robot.ik`.
        solver: "damped"; "analytic": a closed form, the branch nearest to the start; "controller": the budget that the
            machine data grant the controller; "auto": damped, and a closed form where that finds nothing.

    Raises:
        ChainbuildError: an unknown solver, or one that the robot has not.
    """
    if solver not in SOLVERS:
        raise ChainbuildError(f"there is no solver '{solver}'", parameter="solver", permitted=", ".join(SOLVERS))
    if solver == "analytic":
        return solve_analytic(robot, target, start, held)
    if solver == "controller":
        return solve_controller(robot, target, start, held, budget_of(robot))
    found = solve(robot, target, start, held)
    if solver == "damped" or found.success:
        return found
    return _second_opinion(robot, target, start, held, found)


def _second_opinion(
    robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, damped: IkResult
) -> IkResult:
    """Return a closed form's answer where it has one, else what the damped solver said."""
    if method_of(robot, held) == "restarts":
        return damped
    found = solve_analytic(robot, target, start, held)
    return found if found.success else damped
