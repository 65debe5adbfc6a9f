"""Every branch of a regular pose by compiled code (extra `fast`); None where the plain path has to look.

That path takes over where numba is missing, no compiled form knows the machine, limits on sums of axes or drives
decide about whole turns, and at every pose that a form calls doubtful.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.arrays import Indices, Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.ik.branches.compiled.constants import DOUBTFUL, REFUSED, direct_constants, spherical_constants
from chainbuild.ik.branches.core.axis_values import block_of
from chainbuild.ik.branches.core.branches import Branches, isolated, named
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.direct import query_is_direct
from chainbuild.ik.branches.status_turn import has_status, status_turn_rows
from chainbuild.ik.plan import TASK_ROWS, plan_for
from chainbuild.ik.request import Held, IkRequest, start_point
from chainbuild.ik.search.compiled import packing
from chainbuild.ik.search.solver import refusal
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import product_of

_MAX_PREPARED: Final = 64  # every value of a held axis makes another chain
_BRANCHES: Final = 32  # rows for the answer, as many as a form may write


@dataclass(frozen=True, slots=True, eq=False)
class QuickForm:
    """A machine as a compiled form takes it.

    Attributes:
        method: Name of the `SolverPlan` that the form stands for.
        form: Name of the form, see `entries.ENTRIES`.
        arrays: Constants of the form, then the axes in one array and their sizes; see `finish.axes_of`.
        one: Entry point for one pose.
        many: Entry point for many.
        x0: (n_axes,) where branches are counted from without a start [SI].
        has_status: Whether the controller numbers the branches (KIN_TYP 45).
    """

    method: str
    form: str
    arrays: tuple[Vector, Vector, NDArray[np.int64]]
    one: Any
    many: Any
    x0: Vector
    has_status: bool


def quick_branches(mechanism: Mechanism, target: Matrix, start: Vector | None, held: Held | None) -> Branches | None:
    """Return every branch of a pose, nearest to the start first, or None where the plain path has to look.

    Args:
        mechanism: The mechanism.
        target: (4, 4) tool in the workpiece frame [m].
        start: (n_axes,) mm and degrees, or None.
        held: As for `ik_all`.

    Raises:
        AxisValueError: held has a wrong number of values, an unknown name or a non-finite value.
        ChainbuildError: the target is not a rigid transform.
    """
    form, x0 = quick_form(mechanism, start, held)
    if form is None:
        return None
    n = len(x0)
    out = np.empty((_BRANCHES, n + 4))
    count: int = form.one(*form.arrays, target, x0, tolerances.ROTATION_MATRIX, out)
    if count == REFUSED:
        raise refusal(target)
    if count == DOUBTFUL:
        return None
    axes = out[:count, :n] / mechanism.kinematics.si_factors
    left, free = out[:count, n:], ((),) * count
    steps = left[:, 2].astype(np.int64)
    found = Branches(
        axes, left[:, 0], left[:, 1], steps, free, mechanism.task, mechanism.labels, method=form.method,
        free_directions=(isolated(mechanism.labels),) * count,
    )  # fmt: skip
    return named(found, form.method, status_turn_rows(mechanism, axes)) if form.has_status else found


def quick_form(mechanism: Mechanism, start: Vector | None, held: Held | None) -> tuple[QuickForm | None, Vector]:
    """Return the compiled form of a mechanism with some axes held, prepared at first use, and its start [SI]."""
    if held is None and not mechanism.prepared("input axes", lambda: any(axis.held for axis in mechanism.axes)):
        form = mechanism.prepared("quick form", lambda: _quick_form(mechanism, None, None))
        if form is None or start is None:
            return form, _NOWHERE if form is None else form.x0
        return form, start * mechanism.kinematics.si_factors
    x0, fixed = start_point(mechanism, start, held)
    key = fixed.tobytes() + x0[fixed].tobytes()
    form = mechanism.prepared("quick form", lambda: _quick_form(mechanism, start, held), key, _MAX_PREPARED)
    return form, x0


_NOWHERE: Final = np.empty(0)


def _quick_form(mechanism: Mechanism, start: Vector | None, held: Held | None) -> QuickForm | None:
    chain, limits = mechanism.chain, mechanism.limits
    product = product_of(chain)
    if not packing.available() or product is None or chain.loops or limits.together or limits.curved or limits.sums:
        return None
    query = BranchQuery.of(IkRequest(mechanism, np.eye(4), start, held))
    if len(query.structure.free) > TASK_ROWS[mechanism.task]:
        return None  # every branch is on a curve, whose direction the plain path tells
    method, form, constants = _chosen(query)
    packed = None if constants is None else _packed(query, form)
    if constants is None or packed is None:
        return None
    from chainbuild.ik.branches.compiled.entries import ENTRIES

    one, many = ENTRIES[form]
    return QuickForm(method, form, (constants, *packed), one, many, query.x0, has_status(mechanism))


def _chosen(query: BranchQuery) -> tuple[str, str, Vector | None]:
    """Return the plan of a query, the compiled form that stands for it, and its constants."""
    if query_is_direct(query):
        return "direct", "direct", direct_constants(query)
    plan = plan_for(query)
    if plan.name == "spherical wrist" and query.mechanism.task == "pose":
        return plan.name, "spherical", spherical_constants(query.serial())
    return plan.name, "", None


def _packed(query: BranchQuery, form: str) -> tuple[Vector, NDArray[np.int64]] | None:
    """Return the axes of a query in one array, and their sizes, or None where joint values do not give them alone."""
    mechanism, structure = query.mechanism, query.structure
    serial, product, axis_map = query.serial(), product_of(mechanism.chain), mechanism.chain.axis_map
    if product is None or not isinstance(axis_map, AffineMap):
        return None
    linear = structure.linear if form == "direct" else structure.linear[:0]
    columns = structure.rotary[: len(structure.revolute)] if form == "direct" else structure.free
    screws = [screw for screw in serial.screws if form != "direct" or screw.kind == "revolute"]
    joints = np.array([screw.joint for screw in screws], dtype=np.intp)
    block = block_of(mechanism, axis_map, joints, columns)
    if block is None or not block.turns_per_axis:
        return None
    others = np.zeros((len(columns), len(mechanism.axes)))
    others[:, block.others] = block.inverse @ block.from_others
    parts = (
        product.fixed[:, :3], product.prismatic, product.A, product.b, block.inverse, others, block.inverse @ block.b,
        query.lower, query.upper, query.slack, query.periodic, mechanism.kinematics.si_factors,
    )  # fmt: skip
    flat = [np.asarray(part, dtype=float).ravel() for part in parts]
    axis = mechanism.chain.tool_column if mechanism.task == "direction" else -1
    ends = np.cumsum([len(part) for part in flat])
    indices: tuple[Indices, ...] = (block.rows, columns, linear, structure.free)
    sizes = (*product.A.shape, len(columns), len(linear), len(structure.free), axis, *ends)
    return np.concatenate(flat), np.concatenate([sizes, *indices]).astype(np.int64)
