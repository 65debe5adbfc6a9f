"""Damped least-squares steps, and the solution of their equations, compiled."""

from __future__ import annotations

from typing import Final

from chainbuild.ik.search.compiled.kernels import leaf

_USUAL: Final = 6  # axes, and rows of the task, of most arms


@leaf
def solve_in_place(H, g, n):
    """Solve H·x = g, H symmetric (lower half) and positive, both overwritten; x is left in g.

    H becomes L·D·Lᵀ: 1/D on the diagonal, L·D below it.
    """
    for j in range(n):
        inverse = 1.0 / max(H[j, j], 1e-300)
        H[j, j] = inverse
        for i in range(j + 1, n):
            factor = H[i, j] * inverse
            for k in range(j + 1, i + 1):
                H[i, k] -= factor * H[k, j]
            g[i] -= factor * g[j]
    _substitute_back(H, g, n)


@leaf
def _substitute_back(H, g, n):
    """Solve D·Lᵀ·x = g in place; see `solve_in_place`."""
    for i in range(n - 1, -1, -1):
        rest = g[i]
        for k in range(i + 1, n):
            rest -= H[k, i] * g[k]
        g[i] = rest * H[i, i]


@leaf
def solve_again(H, g, n):
    """Solve H·x = g in place once more, with what `solve_in_place` made of H."""
    for j in range(n):
        part = H[j, j] * g[j]
        for i in range(j + 1, n):
            g[i] -= H[i, j] * part
    _substitute_back(H, g, n)


@leaf
def _long_step(rows, n, J, error, H, step, damping):
    """Write the step of at least as many rows as axes."""
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for r in range(rows):
                total += J[r, i] * J[r, j]
            H[i, j] = total
        H[i, i] += damping
        total = 0.0
        for r in range(rows):
            total += J[r, i] * error[r]
        step[i] = total
    solve_in_place(H, step, n)


@leaf
def damped_step(rows, J, error, H, g, step, damping):
    """Write the damped least-squares step of error and Jacobian (their first `rows`) to step."""
    n = len(step)
    if rows < n:
        for i in range(rows):
            for j in range(i + 1):
                total = 0.0
                for m in range(n):
                    total += J[i, m] * J[j, m]
                H[i, j] = total
            H[i, i] += damping
            g[i] = error[i]
        solve_in_place(H, g, rows)
        for m in range(n):
            total = 0.0
            for i in range(rows):
                total += J[i, m] * g[i]
            step[m] = total
        return
    if n == _USUAL and rows == _USUAL:
        _long_step(_USUAL, _USUAL, J, error, H, step, damping)  # compiled anew for these numbers, its loops unrolled
    else:
        _long_step(rows, n, J, error, H, step, damping)
