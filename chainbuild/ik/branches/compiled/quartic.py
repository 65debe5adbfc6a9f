"""The angles at which a sinusoid of the first and second order vanishes, compiled: the roots of a quartic.

With z = exp(i·angle) the sinusoid is c̄2·z⁻² + c̄1·z⁻¹ + c0 + c1·z + c2·z²; its roots on the unit circle are the angles,
the others come in pairs mirrored at it. All four are found at once (Aberth 1973) and told apart by their distance to
the circle.
"""

from __future__ import annotations

import cmath
import math
from typing import Final

import numpy as np

from chainbuild.ik.search.compiled.kernels import jit

_STEPS: Final = 60  # far more than the dozen that roots apart from each other need
_SETTLED: Final = 1e-28  # squared length of a step beyond which nothing is gained
_ON_CIRCLE: Final = 1e-8  # roots this near to the circle are angles, if they are alone there
_BESIDE: Final = 1e-5  # roots this near might be two angles that coincide, or no angle
_FLAT: Final = 1e-9  # share of the largest coefficient: below it the quartic has lost its degree


@jit
def real_angles_of(samples, angles):
    """Write the angles at which a sinusoid vanishes.

    Args:
        samples: (5,) its values at every fifth of a turn.
        angles: (4,) out.

    Returns:
        How many, and whether that is sure.
    """
    c0, c1, c2 = 0.0, 0.0j, 0.0j
    for n in range(5):
        c0 += samples[n] / 5.0
        c1 += samples[n] / 5.0 * cmath.exp(-0.4j * math.pi * n)
        c2 += samples[n] / 5.0 * cmath.exp(-0.8j * math.pi * n)
    largest = max(abs(c0), abs(c1), abs(c2))
    if not abs(c2) > _FLAT * largest:
        return 0, False
    a0, a1, a2, a3 = c2.conjugate() / c2, c1.conjugate() / c2, c0 / c2, c1 / c2
    z = np.empty(4, np.complex128)
    for n in range(4):
        z[n] = cmath.exp(1j * (0.4 + 1.5707963267948966 * n)) * (0.9 + 0.05 * n)
    for _ in range(_STEPS):
        moved = 0.0
        for n in range(4):
            x = z[n]
            value = (((x + a3) * x + a2) * x + a1) * x + a0
            slope = ((4.0 * x + 3.0 * a3) * x + 2.0 * a2) * x + a1
            pull = 0.0j
            for m in range(4):
                if m != n:
                    pull += 1.0 / (x - z[m])
            step = value / (slope - value * pull)
            z[n] = x - step
            moved = max(moved, (step.real * step.real + step.imag * step.imag) / (1.0 + abs(x) ** 2))
        if not moved > _SETTLED:
            break
    count, sure = 0, True
    for n in range(4):
        off = abs(abs(z[n]) - 1.0)
        if off > _BESIDE:
            continue
        if not off <= _ON_CIRCLE:
            return 0, False
        angles[count] = cmath.phase(z[n])
        for m in range(count):
            sure &= abs(math.sin(0.5 * (angles[m] - angles[count]))) > _BESIDE
        count += 1
    return count, sure and count % 2 == 0
