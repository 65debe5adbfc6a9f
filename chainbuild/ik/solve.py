"""Which solver answers: the damped one, a closed form, the controller's budget, or what fits best."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, get_args

from numpy.typing import ArrayLike

from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.analytic import in_closed_form, solve_analytic
from chainbuild.ik.options import IkOptions
from chainbuild.ik.policies.controller import budget_of, solve_controller
from chainbuild.ik.policies.last_check import kept_within
from chainbuild.ik.result import IkResult
from chainbuild.ik.search.solver import certainly_unreachable, solve
from chainbuild.ik.start import Held
from chainbuild.kinematics.mechanism import as_pose

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.ik.policies.redundancy import Preference
    from chainbuild.kinematics.mechanism import Robot

Solver = Literal["auto", "damped", "analytic", "controller"]
SOLVERS: Final[tuple[str, ...]] = get_args(Solver)


def inverse(
    robot: Robot,
    T: pin.SE3 | ArrayLike,
    start: ArrayLike | None,
    held: Held | None,
    solver: str = "auto",
    absolute_c_deg: float | None = None,
    prefer: Preference | None = None,
    options: IkOptions | None = None,
) -> IkResult:
    """Return axis values for a pose as `Robot.ik` does; see there.

    Most calls end with the damped solver's answer; only where it has none, or where something else was asked for, are
    the other solvers and their modules looked at.
    """
    damped = None
    if solver in ("auto", "damped") and absolute_c_deg is None:
        damped = solve(robot, T, start, held, options)
        if damped.success and prefer is None:
            return damped
    target = as_pose(T)
    found = _by_all_means(robot, target, start, held, solver, absolute_c_deg, options, damped)
    if prefer is not None:
        from chainbuild.ik.policies.redundancy import preferred

        found = preferred(robot, found, target, prefer, start, held)
    return kept_within(robot, found, target)


def _by_all_means(
    robot: Robot,
    target: pin.SE3,
    start: ArrayLike | None,
    held: Held | None,
    solver: str,
    absolute_c_deg: float | None,
    options: IkOptions | None,
    damped: IkResult | None,
) -> IkResult:
    """Return what the solver asked for and those that help it out come up with; see `inverse`."""
    from chainbuild.ik.policies.four_axis import solve_programmed
    from chainbuild.ik.policies.sums import kept

    def solve_whole(T: pin.SE3, begin: ArrayLike | None) -> IkResult:
        if solver == "controller":
            begin = start  # its budget counts from where the robot stands
        known = damped if T is target and begin is start else None
        return kept(robot, solve_by(robot, T, begin, held, solver, options, known), T, begin, held, solver)

    return solve_programmed(robot, target, start, held, solve_whole, absolute_c_deg)


def solve_by(
    robot: Robot,
    target: pin.SE3,
    start: ArrayLike | None,
    held: Held | None,
    solver: str = "auto",
    options: IkOptions | None = None,
    damped: IkResult | None = None,
) -> IkResult:
    """Return axis values for a pose by the solver asked for.

    Args:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        start: See `Robot.ik`.
        held: See `Robot.ik`.
        solver: "damped"; "analytic": a closed form, the branch nearest to the start; "controller": the budget that the
            machine data grant the controller; "auto": damped, and a closed form where that finds nothing.
        options: Options of the damped solver.
        damped: What the damped solver said, where it was asked already.

    Raises:
        ChainbuildError: an unknown solver, or one that the robot has not.
    """
    if solver not in SOLVERS:
        raise ChainbuildError(f"there is no solver '{solver}'", parameter="solver", permitted=", ".join(SOLVERS))
    if solver == "analytic":
        return solve_analytic(robot, target, start, held)
    if solver == "controller":
        return solve_controller(robot, target, start, held, budget_of(robot))
    found = solve(robot, target, start, held, options) if damped is None else damped
    if solver == "damped" or found.success:
        return found
    if certainly_unreachable(robot, target, start, held, options):
        return found
    return _second_opinion(robot, target, start, held, found)


def _second_opinion(
    robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, damped: IkResult
) -> IkResult:
    """Return a closed form's answer where it has one, else what the damped solver said."""
    found = in_closed_form(robot, target, start, held)
    return found if found is not None and found.success else damped
