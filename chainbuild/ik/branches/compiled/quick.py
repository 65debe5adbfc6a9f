"""Every branch of a regular pose by compiled code (extra `fast`); None where the plain path has to look.

That path takes over where numba is missing, no compiled form knows the machine, limits on sums of axes or drives
decide about whole turns, and at every pose that a form calls doubtful.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Indices, Integers, Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.ik.branches.arms.parallel_axes import three_parallel_constants
from chainbuild.ik.branches.arms.virtual_joints import common_rotary_axis, with_spin_joint
from chainbuild.ik.branches.compiled.constants import DOUBTFUL, REFUSED, ROWS, direct_constants, spherical_constants
from chainbuild.ik.branches.compiled.general.constants import general_constants
from chainbuild.ik.branches.core.axis_values import block_of
from chainbuild.ik.branches.core.branches import Branches, isolated, named
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.direct import query_is_direct
from chainbuild.ik.branches.status_turn import has_status, status_turn_rows
from chainbuild.ik.plan import TASK_ROWS, plan_for
from chainbuild.ik.request import Held, IkRequest, start_point
from chainbuild.ik.search.compiled import packing
from chainbuild.ik.search.solver import refusal
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import product_of

_MAX_PREPARED: Final = 64  # every value of a held axis makes another chain


@dataclass(frozen=True, slots=True, eq=False)
class QuickForm:
    """A machine as a compiled form takes it.

    Attributes:
        method: Name of the `SolverPlan` that the form stands for.
        form: Name of the form, see `entries.FORMS`.
        constants: Constants of the form.
        axes: The axes in one array, and their sizes; see `axes.axes_of`.
        x0: (n_axes,) where branches are counted from without a start [SI].
        has_status: Whether the controller numbers the branches (KIN_TYP 45).
        by_axes: (6, n_axes) joint values in the order of the screws by SI axis values,
        at_zero: (6,) and where these are 0.
        keep: (6,) joint values of x0.
        isolated: Free directions of branches that have none.
    """

    method: str
    form: str
    constants: Vector
    axes: tuple[Vector, Integers]
    x0: Vector
    has_status: bool
    by_axes: Matrix
    at_zero: Vector
    keep: Vector
    isolated: tuple[Matrix, ...]

    def write(
        self, targets: Matrix, x0: Vector, found: Matrix, left: Matrix, along: Matrix, counts: Integers
    ) -> tuple[int, bool]:
        """Write the branches of poses (N, 4, 4), as `entries.finish_poses` does; return what that returns."""
        entries, values = _entries(), np.empty((len(targets), ROWS, 7))
        keep = self.keep if x0 is self.x0 else self.by_axes @ x0 + self.at_zero
        entries.FORMS[self.form](self.constants, targets, tolerances.ROTATION_MATRIX, keep, values, counts)
        last: tuple[int, bool] = entries.finish_poses(*self.axes, targets, x0, values, counts, found, left, along)
        return last


@cache
def _entries() -> Any:
    """Return the module of compiled entry points; numba is imported here, at first use."""
    from chainbuild.ik.branches.compiled import entries as compiled_entries

    return compiled_entries


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
    rows, left, along = np.empty((1, ROWS, n)), np.empty((1, ROWS, 5)), np.empty((1, ROWS, n))
    count, loose = form.write(target[None], x0, rows, left, along, np.empty(1, np.int64))
    if count == REFUSED:
        raise refusal(target)
    if count == DOUBTFUL:
        return None
    free: tuple[tuple[str, ...], ...] = _NONE_FREE[count]
    directions, told = form.isolated[:count], left[0, :count]
    if loose:
        names, axes = mechanism.labels.names, told[:, 4].astype(int).tolist()
        free = tuple((names[n],) if n >= 0 else () for n in axes)
        directions = tuple(along[0, k : k + 1] if n >= 0 else directions[k] for k, n in enumerate(axes))
    found = Branches(
        rows[0, :count], told[:, 0], told[:, 1], told[:, 2].astype(np.int64), free, mechanism.task, mechanism.labels,
        method=form.method, free_directions=directions,
    )  # fmt: skip
    return named(found, form.method, status_turn_rows(mechanism, found.axes)) if form.has_status else found


def write_branches_of(form: QuickForm, targets: Matrix, x0: Vector, found: Matrix, counts: Integers) -> None:
    """Write the branches of many poses on all cores.

    Args:
        form: The form.
        targets: (N, 4, 4) tool in the workpiece frame [m].
        x0: (n_axes,) start in SI.
        found: (N, ROWS, n_axes) out: axis values, mm and degrees, nearest to the start first.
        counts: (N,) out: numbers of branches, DOUBTFUL or REFUSED.
    """

    def write(part: slice) -> None:
        left, along = np.empty((part.stop - part.start, ROWS, 5)), np.empty((part.stop - part.start, ROWS, len(x0)))
        form.write(targets[part], x0, found[part], left, along, counts[part])

    parts = [slice(n, min(n + _PART, len(targets))) for n in range(0, len(targets), _PART)]
    if len(parts) == 1:
        write(parts[0])
        return
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        list(threads.map(write, parts))


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


_PART: Final = 1024  # poses that one core takes at a time
_NOWHERE: Final = np.empty(0)
_NONE_FREE: Final = tuple(((),) * count for count in range(ROWS + 1))


def _quick_form(mechanism: Mechanism, start: Vector | None, held: Held | None) -> QuickForm | None:
    chain, limits = mechanism.chain, mechanism.limits
    product = product_of(chain)
    if not packing.available() or product is None or chain.loops or limits.curved:
        return None
    query = BranchQuery.of(IkRequest(mechanism, np.eye(4), start, held))
    if len(query.structure.free) > TASK_ROWS[mechanism.task]:
        return None  # every branch is on a curve, whose direction the plain path tells
    method, form, constants = _chosen(query)
    joints = np.array([screw.joint for screw in _screws(query, form)], dtype=np.intp)
    packed = None if constants is None else _packed(query, form, joints)
    if constants is None or packed is None or not isinstance(chain.axis_map, AffineMap):
        return None
    by_axes, at_zero = np.zeros((6, len(query.x0))), np.zeros(6)
    by_axes[: len(joints)], at_zero[: len(joints)] = chain.axis_map.A[joints], chain.axis_map.b[joints]
    keep = by_axes @ query.x0 + at_zero
    alone = (isolated(mechanism.labels),) * ROWS
    return QuickForm(method, form, constants, packed, query.x0, has_status(mechanism), by_axes, at_zero, keep, alone)


def _chosen(query: BranchQuery) -> tuple[str, str, Vector | None]:
    """Return the plan of a query, the compiled form that stands for it, and its constants."""
    if query_is_direct(query):
        return "direct", "direct", direct_constants(query)
    plan, serial = plan_for(query), _six_joints(query)
    if plan.name == "spherical wrist" and serial is not None:
        constants = spherical_constants(serial)
        if constants is not None:
            return plan.name, "spherical", constants
    if plan.name == "three parallel axes" and serial is not None:
        return plan.name, "three parallel axes", three_parallel_constants(serial)
    if plan.name in {"spherical wrist", "elimination"} and serial is not None:
        return plan.name, "general", general_constants(serial)
    return plan.name, "", None


def _six_joints(query: BranchQuery) -> Serial | None:
    """Return the six joints that a form solves for, a turn about the tool vector among them, or None."""
    serial, task = query.serial(), query.mechanism.task
    if task == "pose":
        return serial
    if task != "direction" or len(serial.screws) != 5 or common_rotary_axis(serial) is not None:
        return None
    return with_spin_joint(serial, query.mechanism.chain.tool_column)


def _screws(query: BranchQuery, form: str) -> list[Screw]:
    """Return the joints whose values a form tells."""
    return [screw for screw in query.serial().screws if form != "direct" or screw.kind == "revolute"]


def _packed(query: BranchQuery, form: str, joints: Indices) -> tuple[Vector, Integers] | None:
    """Return the axes of a query in one array, and their sizes, or None where joint values do not give them alone."""
    mechanism, structure = query.mechanism, query.structure
    product, axis_map = product_of(mechanism.chain), mechanism.chain.axis_map
    if product is None or not isinstance(axis_map, AffineMap):
        return None
    linear = structure.linear if form == "direct" else structure.linear[:0]
    columns = structure.rotary[: len(structure.revolute)] if form == "direct" else structure.free
    block = block_of(mechanism, axis_map, joints, columns)
    if block is None or not block.turns_per_axis or len(joints) != len(columns):
        return None
    others = np.zeros((len(columns), len(mechanism.axes)))
    others[:, block.others] = block.inverse @ block.from_others
    factors = mechanism.kinematics.si_factors
    parts = (
        product.fixed[:, :3], product.prismatic, product.A, product.b, block.inverse, others, block.inverse @ block.b,
        query.lower, query.upper, query.slack, query.periodic, factors, *_sums(mechanism),
    )  # fmt: skip
    flat = [np.asarray(part, dtype=float).ravel() for part in parts]
    axis = mechanism.chain.tool_column if mechanism.task == "direction" else -1
    ends = np.cumsum([len(part) for part in flat])
    movers = query.undetermined_axes(joints, [True] * len(joints), structure.free)
    indices: tuple[Indices | list[int], ...] = (block.rows, columns, movers, linear, structure.free)
    sums = len(mechanism.limits.sums)
    sizes = (*product.A.shape, len(columns), len(linear), len(structure.free), axis, sums, *ends)
    return np.concatenate(flat), np.concatenate([sizes, *indices]).astype(np.int64)


def _sums(mechanism: Mechanism) -> tuple[Matrix, Vector, Vector, Vector]:
    """Return the limits on sums of SI axis values: rows (s, n_axes), lower and upper, and which axes take part."""
    limits, factors = mechanism.limits, mechanism.kinematics.si_factors
    rows: Matrix = np.array([one.sum.coefficients for one in limits.sums]).reshape(-1, len(factors)) / factors
    offset = np.array([one.sum.offset for one in limits.sums])
    lower = np.array([one.lower for one in limits.sums]) - offset
    upper = np.array([one.upper for one in limits.sums]) - offset
    return rows, lower, upper, np.array([float(n in limits.together) for n in range(len(factors))])
