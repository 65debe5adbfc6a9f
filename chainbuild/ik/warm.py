"""Compiling ahead: every entry point of the compiled path is called once, on shipped machines."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from chainbuild.errors import ChainbuildError
from chainbuild.formats.load import load
from chainbuild.frames import transform
from chainbuild.ik.branches.compiled.doubtful.settle import settle_ahead
from chainbuild.ik.branches.compiled.forms import quick_form
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.branches.many import ik_all_batch
from chainbuild.ik.plan import plan_of
from chainbuild.ik.request import IkRequest
from chainbuild.ik.rtcp import linear_axes_batch
from chainbuild.ik.search.batch import solve_batch
from chainbuild.ik.search.compiled import packing
from chainbuild.ik.search.path import solve_path
from chainbuild.ik.search.solver import search
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting

_ARM: Final = "kr6r900"
_ARM_DEG: Final = (10.0, -80.0, 70.0, 20.0, 40.0, 30.0)  # inside its limits, far from singular
_BENT_DEG: Final = 20.0  # of every axis: inside the limits of all, far from singular
_X, _Y, _Z = np.eye(3).tolist()
_THREE_PARALLEL: Final = (_Z, _Y, _Y, _Y, _Z, _Y)
_ANYHOW: Final = (_Z, _Y, [0.6, 0.0, 0.8], _X, [0.0, 0.6, 0.8], _Y)
_WITH_STATUS: Final = "kr6r900_2"  # KIN_TYP 45: the control numbers its branches
_MANY: Final = 512  # repetitions: enough poses for the entry point of large batches
_MACHINE: Final = "ac_table_kin58"  # of RTCP: its linear axes are solved alone


def warm_up(*, progress: Progress = False) -> Mapping[str, float]:
    """Compile all of inverse kinematics ahead, so that no later call waits for it.

    The machine code is kept on disk: once after an installation is enough, such as while an image is built.

    Args:
        progress: True: a bar on standard error; a function: called with the entry points done and all of them.

    Returns:
        Entry point → seconds it took; next to nothing where its code was kept already.

    Raises:
        ChainbuildError: numba (the extra `fast`) is not installed.
    """
    if not packing.available():
        raise ChainbuildError("nothing to compile: numba is not installed", hint="pip install 'chainbuild[fast]'")
    arm, machine = Mechanism(load(_ARM).chain()), Mechanism(load(_MACHINE).chain())
    start, zeros = np.array(_ARM_DEG), np.zeros((1, len(machine.axes)))
    poses = np.array([arm.fk(start + shift).homogeneous for shift in (0.0, 0.1)])
    others = tuple(_other_arms(arm))
    calls: Mapping[str, Callable[[], object]] = {
        "one pose": partial(search, IkRequest(arm, poses[0], start)),
        "many poses": partial(solve_batch, arm, np.tile(poses, (_MANY, 1, 1)), start),
        "a path": partial(solve_path, arm, poses, start),
        "all branches of many poses": partial(ik_all_batch, arm, poses),
        "all branches of a pose": partial(ik_all, arm, poses[0]),
        **{f"all branches: {plan_of(one).name}": _branches_of(one) for one in (machine, *others)},
        "all branches of many poses: three parallel axes": partial(
            ik_all_batch, others[0], others[0].fk_batch(start[None])
        ),
        "status and turn": _branches_of(Mechanism(load(_WITH_STATUS).chain())),
        "all branches of a singular pose": partial(_settle_ahead, others[-1]),
        "linear axes of many positions": partial(linear_axes_batch, machine, np.zeros((1, 3)), zeros),
    }
    took: dict[str, float] = {}
    with counting(len(calls), progress, "entry points") as advance:
        for name, call in calls.items():
            begin = time.perf_counter()
            call()
            took[name] = time.perf_counter() - begin
            advance(1)
    return took


def _branches_of(mechanism: Mechanism) -> Callable[[], object]:
    return partial(ik_all, mechanism, mechanism.fk(np.full(len(mechanism.axes), _BENT_DEG)))


def _settle_ahead(mechanism: Mechanism) -> None:
    form, x0 = quick_form(mechanism, None, None)
    if form is not None:
        settle_ahead(form, mechanism.fk(np.full(len(mechanism.axes), _BENT_DEG)).homogeneous, x0)


def _other_arms(arm: Mechanism) -> Iterator[Mechanism]:
    """Yield arms with other axes: three parallel, the last two of which meet, and none parallel or meeting another."""
    for directions, last in ((_THREE_PARALLEL, 0.0), (_ANYHOW, 0.1)):
        shifts = [[0.1, 0.2 * n, 0.3] for n in range(5)] + [[last, 1.0, 0.3]]
        joints = (
            replace(joint, direction=np.array(direction), T_parent_joint=transform(None, shifts[n]))
            for n, (joint, direction) in enumerate(zip(arm.chain.joints, directions, strict=True))
        )
        yield Mechanism(replace(arm.chain, joints=tuple(joints)))
