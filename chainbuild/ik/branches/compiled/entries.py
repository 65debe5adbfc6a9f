"""Entry points of compiled closed forms. They release the interpreter, so that threads share many poses.

Forms write joint values, one entry point for all of them makes branches of these: so nobody waits for the compilation
of another form. numba keeps the code of an entry point by what it closes over; a form among that would never be found
again: forms are globals, their files in the fingerprint, and each has an entry point of its own.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final
from zlib import crc32

from chainbuild import tolerances
from chainbuild.ik import rules
from chainbuild.ik.branches.arms import parallel_axes
from chainbuild.ik.branches.compiled import (
    angle_pairs,
    direct,
    finish,
    small,
    spherical,
    status,
    three_parallel,
)
from chainbuild.ik.branches.compiled import axes as machine_axes
from chainbuild.ik.branches.compiled import constants as form_constants
from chainbuild.ik.branches.compiled.axes import axes_of, finish_room
from chainbuild.ik.branches.compiled.constants import REFUSED, UNSURE
from chainbuild.ik.branches.compiled.direct import direct_branches
from chainbuild.ik.branches.compiled.doubtful import beside, descents, steps
from chainbuild.ik.branches.compiled.doubtful import curves as followed_curves
from chainbuild.ik.branches.compiled.doubtful.beside import places_beside
from chainbuild.ik.branches.compiled.doubtful.curves import Curves, nearest_on_curve
from chainbuild.ik.branches.compiled.finish import finished
from chainbuild.ik.branches.compiled.general import constants as general_constants
from chainbuild.ik.branches.compiled.general import eigen, equations, solutions, solve
from chainbuild.ik.branches.compiled.general.solve import general_branches
from chainbuild.ik.branches.compiled.spherical import spherical_branches
from chainbuild.ik.branches.compiled.status import write_status
from chainbuild.ik.branches.compiled.three_parallel import three_parallel_branches
from chainbuild.ik.branches.core import branches, subproblems
from chainbuild.ik.search.compiled import kernels as compiled_kernels
from chainbuild.ik.search.compiled import least_squares
from chainbuild.ik.search.compiled import search as compiled_search
from chainbuild.ik.search.compiled.entries import kept_jit
from chainbuild.ik.search.compiled.kernels import FAST
from chainbuild.ik.search.compiled.search import is_rigid


def _finish(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def finish_poses(data, sizes, targets, x0, values, counts, found, left, along):
        """Write the branches among joint values; return the last of counts, and whether a branch there is on a curve.

        Args:
            data: The axes in one array,
            sizes: and their sizes, see `axes_of`.
            targets: (N, 4, 4) tool in the workpiece frame [m].
            x0: (n,) start in SI; held axes have their values.
            values: (N, ROWS, COLUMNS) what a form wrote.
            counts: (N,) what it wrote; out: how many branches there are, UNSURE less the rows written, or REFUSED.
            found: (N, ROWS, n) out, see `finished`.
            left: (N, ROWS, TOLD) out, likewise.
            along: (N, ROWS, n) out, likewise.
        """
        axes, count, loose = axes_of(data, sizes), 0 * fingerprint, False
        room = finish_room(axes)
        for i in range(len(targets)):
            count = counts[i]
            if count > 0:
                kept, sure = finished(axes, room, targets[i], x0, values[i], count, found[i], left[i], along[i])
                count = kept if sure else UNSURE - count
            counts[i] = count
            loose = False
            for r in range(count):
                loose |= left[i, r, 4] != -1.0
        return count, loose

    return finish_poses


def _beside(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def beside_pose(data, sizes, target, x0, values, counts, reached, points, pieces, owners, known, places, count):
        """Add solutions of a pose to places; see `places_beside`, whose axes and curves are packed here."""
        axes, curves = axes_of(data, sizes), Curves(points, pieces, owners, known)
        return places_beside(
            axes, finish_room(axes), target, x0, values, counts, reached, curves, places, count + 0 * fingerprint
        )

    return beside_pose


def _nearest(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def nearest_places(data, sizes, target, x0, points, pieces, owners, known, places, count):
        """Write of each curve the place that is nearest to the start to its row of places, the curve behind it.

        Args:
            data: See `finish_poses`.
            sizes: Likewise.
            target: (4, 4) tool in the workpiece frame [m].
            x0: (n,) start in SI; held axes have their values.
            points: See `Curves`.
            pieces: Likewise.
            owners: Likewise.
            known: Likewise.
            places: (·, n + 3) see `places_beside`; out: in its last column the curve, -1: none, -2: of a curve that
                stands there already or has no place inside the limits.
            count: How many rows.
        """
        axes, curves, n = axes_of(data, sizes), Curves(points, pieces, owners, known), len(x0) + 0 * fingerprint
        room = finish_room(axes)
        for i in range(count):
            if places[i, n + 2] >= 0.0:
                owner, is_known = owners[int(places[i, n + 2])], False
                for k in range(i):
                    is_known |= places[k, n + 2] == owner
                inside = not is_known and nearest_on_curve(axes, room, target, x0, curves, owner, places[i])
                places[i, n + 2] = owner if inside else -2.0

    return nearest_places


def _spherical(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def spherical_poses(constants, targets, rigid, keep, values, counts):
        """Write the joint values of poses.

        Args:
            constants: Those of the form.
            targets: (N, 4, 4) tool in the workpiece frame [m].
            rigid: Permitted deviation of a matrix from a rotation.
            keep: (6,) joint values of the start, for those that are free.
            values: (N, ROWS, COLUMNS) out: joint values in the order of the screws, see `COLUMNS`.
            counts: (N,) out: how many rows, UNSURE less that or REFUSED.
        """
        for i in range(len(targets)):
            counts[i] = REFUSED + 0 * fingerprint
            values[i, :, 6:] = -1.0
            if is_rigid(targets[i], rigid):
                count, sure = spherical_branches(constants, targets[i], keep, values[i])
                counts[i] = count if sure else UNSURE - count

    return spherical_poses


def _direct(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def direct_poses(constants, targets, rigid, keep, values, counts):
        """Write the values of rotary joints; see `spherical_poses`."""
        for i in range(len(targets)):
            counts[i] = REFUSED + 0 * fingerprint
            values[i, :, 6:] = -1.0
            if is_rigid(targets[i], rigid):
                count, sure = direct_branches(constants, targets[i], keep, values[i])
                counts[i] = count if sure else UNSURE - count

    return direct_poses


def _general(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def general_poses(constants, targets, rigid, keep, values, counts):
        """Write the joint values of poses; see `spherical_poses`."""
        for i in range(len(targets)):
            counts[i] = REFUSED + 0 * fingerprint
            values[i, :, 6:] = -1.0
            if is_rigid(targets[i], rigid):
                count, sure = general_branches(constants, targets[i], values[i])
                counts[i] = count if sure else UNSURE - count

    return general_poses


def _three_parallel(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def three_parallel_poses(constants, targets, rigid, keep, values, counts):
        """Write the joint values of poses; see `spherical_poses`."""
        for i in range(len(targets)):
            counts[i] = REFUSED + 0 * fingerprint
            values[i, :, 6:] = -1.0
            if is_rigid(targets[i], rigid):
                count, sure = three_parallel_branches(constants, targets[i], keep, values[i])
                counts[i] = count if sure else UNSURE - count

    return three_parallel_poses


def _status(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def status_rows(constants, values, bits):
        """Write status and turn of rows of axis values; see `write_status`."""
        if fingerprint >= 0:
            write_status(constants, values, bits)

    return status_rows


def _fingerprint(*modules: Any) -> int:
    return crc32(b"".join(Path(str(module.__file__)).read_bytes() for module in modules))


_SMALL: Final = _fingerprint(small, subproblems, form_constants, compiled_kernels, compiled_search)
_FINISH: Final = _fingerprint(
    machine_axes, finish, form_constants, branches, compiled_kernels, least_squares, rules, tolerances
)
finish_poses: Final = _finish(_FINISH)
beside_pose: Final = _beside(_FINISH ^ _fingerprint(beside, descents, followed_curves, steps))
nearest_places: Final = _nearest(_FINISH ^ _fingerprint(followed_curves, steps))
status_rows: Final = _status(_fingerprint(status, tolerances, compiled_kernels))
# Form → its entry point.
FORMS: Final = {
    "spherical": _spherical(_SMALL ^ _fingerprint(spherical, angle_pairs)),
    "direct": _direct(_SMALL ^ _fingerprint(spherical, angle_pairs, direct)),
    "three parallel axes": _three_parallel(_SMALL ^ _fingerprint(parallel_axes, angle_pairs, three_parallel)),
    "general": _general(_SMALL ^ _fingerprint(general_constants, eigen, equations, solutions, solve)),
}
