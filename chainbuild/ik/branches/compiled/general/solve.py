"""All branches of one pose of six rotary joints in any arrangement: compiled code.

Of the eigenvalues (see `equations`) each real one must lead to a solution of its own, and each other one must be
complex beyond doubt, or lead to a complex solution of its own: only then are the solutions certainly all.
"""

from __future__ import annotations

import math
from typing import Any, Final, NamedTuple

import numpy as np

from chainbuild.ik.branches.compiled.general.constants import (
    BACK,
    CENTRE,
    JOINTS,
    OPENINGS,
    PER_OPENING,
    ROLES,
    SCALE,
)
from chainbuild.ik.branches.compiled.general.eigen import eigenvalues_of
from chainbuild.ik.branches.compiled.general.equations import write_best_companion, write_equations
from chainbuild.ik.branches.compiled.general.solutions import (
    MET,
    SAME,
    is_complex_solution,
    is_regular,
    largest_imaginary,
    polish,
    write_values,
)
from chainbuild.ik.search.compiled.kernels import jit, leaf

_USELESS: Final = 1e7  # entries of the matrix above which its eigenvalues have no digits
_APART: Final = 1e-9  # share below which the eliminated joints are not told apart
_NOISE: Final = 1e-13  # times the square of the largest entry: 10 to 100 times what rounding makes of 0; rarely less
_FAR_ASIDE: Final = 3.0  # imaginary part of a joint's value: more than rounding makes, and too much for Newton's steps
_BESIDE: Final = 1e-2  # of a sphere: complex eigenvalues so near to the real ones must lead to complex solutions


class LoopRoom(NamedTuple):
    """Scratch of one pose; the arrays bear the names they have in `equations` and `solutions`."""

    G: Any  # (3, 4)
    rows: Any  # (10, 27)
    right: Any  # (15, 23)
    nine: Any  # (16, 126)
    B: Any  # (12, 32)
    T: Any  # (3, 4)
    J: Any  # (6, 7)
    q: Any  # (6,)
    complex_nine: Any  # (6, 14)
    complex_B: Any  # (12, 13)
    complex_T: Any  # (3, 4)
    complex_J: Any  # (6, 7)
    z: Any  # (6,)
    others: Any  # (10, 6) complex solutions
    real: Any  # (20,) eigenvalues
    imaginary: Any  # (20,)


@jit
def loop_room():
    """Return the scratch."""
    kind = np.complex128
    return LoopRoom(
        np.empty((3, 4)), np.empty((10, 27)), np.empty((15, 23)), np.empty((16, 126)), np.empty((12, 32)),
        np.empty((3, 4)), np.empty((JOINTS, JOINTS + 1)), np.empty(JOINTS), np.empty((6, 14), kind),
        np.empty((12, 13), kind), np.empty((3, 4), kind), np.empty((JOINTS, JOINTS + 1), kind), np.empty(JOINTS, kind),
        np.empty((10, JOINTS), kind), np.empty(20), np.empty(20),
    )  # fmt: skip


@leaf
def scaled(constants, T, G):
    """Write the loop's motion (3, 4) at a pose (4, 4): as seen from the middle of the axes, in units of the arm."""
    for i in range(3):
        for j in range(4):
            total = 0.0
            for k in range(3):
                total += T[i, k] * constants[BACK + 4 * k + j]
            G[i, j] = total
        G[i, 3] = (G[i, 3] + T[i, 3] - constants[CENTRE + i]) / constants[SCALE]


@leaf
def distances(real, imaginary, size, x, y):
    """Return the product of a number's distances to all eigenvalues, on the sphere; those above a quarter are 1."""
    product, length = 1.0, 1.0 + x * x + y * y
    for n in range(size):
        across, along = real[n] - x, imaginary[n] - y
        other = 1.0 + real[n] * real[n] + imaginary[n] * imaginary[n]
        product *= min(1.0, 16.0 * (across * across + along * along) / (length * other))
    return math.sqrt(product)


@leaf
def is_complex(real, imaginary, size, k, noise):
    """Tell whether an eigenvalue is complex beyond doubt.

    The product of the distances to all eigenvalues is the characteristic polynomial. Rounding moves eigenvalues only to
    where it is small: to none on the real line if it is not small on a line between that and the eigenvalue.
    """
    half = 0.5 * math.atan2(2.0 * real[k], 1.0 - real[k] * real[k] - imaginary[k] * imaginary[k])
    if distances(real, imaginary, size, math.tan(half), 0.0) > noise:
        return True
    # Tangents of h/2 with one imaginary part of h/2: half that of the eigenvalue.
    a, b = real[k], abs(imaginary[k])
    high = 0.125 * math.log((a * a + (1.0 + b) * (1.0 + b)) / (a * a + (1.0 - b) * (1.0 - b)))
    t = math.tanh(high)
    for n in range(size):
        half = 0.5 * math.atan2(2.0 * real[n], 1.0 - real[n] * real[n] - imaginary[n] * imaginary[n])
        c, s = math.cos(half), math.sin(half)
        below = c * c + s * s * t * t
        if not distances(real, imaginary, size, c * s * (1.0 - t * t) / below, t / below) > noise:
            return False
    return True


@leaf
def is_new(values, count, q):
    """Tell whether joint values differ from the first rows of others by more than whole turns."""
    for r in range(count):
        largest = 0.0
        for n in range(JOINTS):
            largest = max(largest, abs(math.sin(0.5 * (values[r, n] - q[n]))))
        if 2.0 * largest < SAME:
            return False
    return True


@leaf
def add_solutions(constants, part, room, half, angle, size, noise, values, found, starts):
    """Write the solutions of one opening behind those found before.

    At the end of values stand the real parts of complex solutions: poses beside this one may have two branches there.

    Returns how many solutions there are then, how many of the eigenvalues may be real, -1 if a solution is singular,
    and how many rows stand at the end.
    """
    G, T, J, q = room.G, room.T, room.J, room.q
    z, complex_T, complex_J = room.z, room.complex_T, room.complex_J
    perhaps, aside, regular = 0, 0 * size, True
    for k in range(size):
        a, b = room.real[k], room.imaginary[k]
        far = b > _BESIDE * (1.0 + a * a + b * b)
        certain = b > 0.0 and is_complex(room.real, room.imaginary, size, k, noise)
        if b < 0.0 or (far and certain):
            continue
        if b > 0.0:
            complex_hidden = angle - 1.0j * np.log(complex(1.0 - b, a) / complex(1.0 + b, -a))
            write_values(
                constants, part, room.rows, half, room.right, complex_hidden, room.complex_nine,
                room.complex_B, G, z, complex_T, complex_J,
            )  # fmt: skip
            place = int(part[ROLES + 2])
            if is_complex_solution(constants, place, complex_hidden, G, z, complex_T, complex_J, room.others, aside):
                if found + starts < len(values):
                    starts += 1
                    for n in range(JOINTS):
                        values[len(values) - starts, n] = room.others[aside, n].real
                aside += 1
                continue
            if certain and largest_imaginary(z) > _FAR_ASIDE:
                continue
            perhaps += 1
        perhaps += 1
        hidden = angle + 2.0 * math.atan(a)
        write_values(constants, part, room.rows, half, room.right, hidden, room.nine, room.B, G, q, T, J)
        miss = polish(constants, G, q, T, J)
        if miss < MET and is_new(values, found, q) and found < len(values) - starts:
            for n in range(JOINTS):
                values[found, n] = q[n]
            found += 1
            regular = regular and is_regular(J)
    return found, perhaps if regular else -1, starts


@jit
def general_branches(constants, T, values):
    """Write the solutions of a pose.

    Args:
        constants: See `general_constants`.
        T: (4, 4) tool in the workpiece frame [m].
        values: (32, 6) out: joint values in the order of the screws.

    Returns:
        How many rows were written, and whether these are certainly all; if not, some may be no solutions.
    """
    room = loop_room()
    P, product, motion, null = np.empty((6, 14)), np.empty((10, 15)), np.empty((15, 15)), np.empty((13, 20))
    combined, A, kept = np.empty((10, 6)), np.empty((21, 21)), np.empty((21, 21))
    scaled(constants, T, room.G)
    found, starts = int(0.0 * constants[0]), 0
    for n in range(int(constants[0])):
        part = constants[OPENINGS + n * PER_OPENING : OPENINGS + (n + 1) * PER_OPENING]
        half, apart = write_equations(
            part, room.G, room.right, P, product, motion, null, combined, room.rows, room.nine
        )
        angle, size, largest = write_best_companion(room.rows, half, room.nine, room.B, A, kept)
        if not (apart > _APART and largest < _USELESS and eigenvalues_of(A, size, room.real, room.imaginary)):
            continue
        noise = _NOISE * largest * largest
        found, perhaps, starts = add_solutions(constants, part, room, half, angle, size, noise, values, found, starts)
        if perhaps == found:
            return found, True
        if perhaps < 0 or 0 < perhaps < found:
            break
    for k in range(starts):
        for n in range(JOINTS):
            values[found + k, n] = values[len(values) - starts + k, n]
    return found + starts, False
