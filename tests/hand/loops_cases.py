"""Random machines of the closed loops, as HD values and channel lists, and axis values at which they close."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .loops_hand import LOOP_CHOICES, LOOP_INVERSES, LOOPS, Conv, Hd
from .tables_algebra import RAW_UNIT

FLAGS: dict[int, frozenset[int]] = {
    12: frozenset({8}),
    21: frozenset({12}),
    37: frozenset(),
    209: frozenset({8, 31, 40, 41}),
}
RODS = {12: (7,), 21: (2, 3), 37: (6,), 209: (7,)}
# Conventions that change the pose, with their choices; those of the last rows are shared with the tables.
CHOICES: dict[int, dict[str, tuple[str, ...]]] = {
    kin: {name: choices for name, choices in LOOP_CHOICES.items() if name.split("_")[0] in families}
    for kin, families in {12: ("kin12",), 21: ("kin21",), 37: ("kin37",), 209: ("kin12", "kin209")}.items()
}
CHOICES[209] |= {
    "offset_inside_flag": ("inside", "outside"),
    "table_flag_coding": ("zero_one", "plus_minus_one"),
    "table_rotary_sense": ("right_handed", "left_handed"),
}


def _either(rng: np.random.Generator, most: float) -> float:
    """Return a value of either sign, or zero once in three."""
    return 0.0 if rng.random() < 1 / 3 else round(float(rng.uniform(-most, most)), 3)


def _within(rng: np.random.Generator, low: float, high: float) -> float:
    return round(float(rng.uniform(low, high)), 3)


def _tripod(rng: np.random.Generator) -> dict[int, float]:
    column, platform = _within(rng, 300.0, 900.0), _within(rng, 60.0, 200.0)
    hd = {n: _either(rng, 300.0) for n in (1, 2, 3, 4)}
    hd |= {5: column, 6: platform, 7: round((column - platform) * float(rng.uniform(1.3, 2.2)), 3)}
    if rng.random() < 0.5:
        hd |= {8: 1.0, 9: _within(rng, 95.0, 145.0), 10: _within(rng, 95.0, 145.0)}
    return hd


def _tripod_with_table(rng: np.random.Generator, conv: Conv) -> dict[int, float]:
    hd = _tripod(rng) | {30: _either(rng, 170.0), 31: float(rng.integers(2))}
    hd |= {n: _either(rng, 300.0) for n in range(32, 38)} | {n: _either(rng, 90.0) for n in (38, 39)}
    signed = conv.get("table_flag_coding") == "plus_minus_one"
    return hd | {n: float(rng.choice((-1, 1) if signed else (0, 1))) for n in (40, 41)}


def _delta(rng: np.random.Generator) -> dict[int, float]:
    base, platform, lever = _within(rng, 100.0, 300.0), _within(rng, 30.0, 90.0), _within(rng, 150.0, 350.0)
    rod = round((base - platform + lever) * float(rng.uniform(1.3, 2.0)), 3)
    hd = {1: _either(rng, 200.0), 4: platform, 5: base, 6: rod, 7: lever, 13: _either(rng, 800.0)}
    return hd | {n: _either(rng, 90.0) for n in (8, 9, 10)}


def _lambda(rng: np.random.Generator) -> dict[int, float]:
    hd = {n: _within(rng, 300.0, 700.0) for n in (2, 3)} | {4: _within(rng, 150.0, 600.0), 6: _either(rng, 170.0)}
    hd |= {n: _either(rng, 200.0) for n in (1, 5, 7, 10)} | {8: 0.0, 9: 90.0, 11: _either(rng, 150.0)}
    return hd | {12: float(rng.integers(2))}


def random_hd(kin: int, rng: np.random.Generator, conv: Conv) -> dict[int, float]:
    """Draw HD values (mm, degrees, flags) of a machine that can be built; offsets and tool may be 0."""
    if kin == 209:
        return _tripod_with_table(rng, conv)
    return {12: _tripod, 21: _lambda, 37: _delta}[kin](rng)


def _anywhere(kin: int, hd: Hd, rng: np.random.Generator) -> list[float]:
    """Draw axis values of which a good part closes."""
    if kin == 21:
        x1 = float(rng.uniform(-600.0, 600.0))
        apart = (hd[2] + hd[3]) * float(rng.uniform(-1.0, 1.0))
        return [x1, x1 + apart, float(rng.uniform(-400.0, 400.0)), float(rng.uniform(-175.0, 175.0))]
    if kin == 37:
        return [float(rng.uniform(-40.0, 85.0)) + hd[8 + n] for n in range(3)]
    height = float(rng.uniform(-600.0, 600.0))
    slides = (height + hd[7] * rng.uniform(-0.35, 0.35, 3)).tolist()
    return [*slides, *rng.uniform(-170.0, 170.0, 2).tolist()] if kin == 209 else slides


def is_steady(kin: int, hd: Hd, axes: Sequence[float], conv: Conv) -> bool:
    """Tell whether the struts close with room to spare: also with each of them a hundredth shorter or longer."""
    near = ({**hd, n: hd[n] * scale} for n in RODS[kin] for scale in (0.99, 1.01))
    return all(LOOPS[kin](one, axes, 0.0, conv) is not None for one in (hd, *near))


def random_closing(kin: int, hd: Hd, conv: Conv, rng: np.random.Generator) -> list[float]:
    """Draw axis values at which the machine closes with room to spare."""
    for _ in range(10_000):
        axes = _anywhere(kin, hd, rng)
        if is_steady(kin, hd, axes, conv):
            return axes
    raise AssertionError(f"KIN_TYP {kin} closes nowhere: {hd}")


def random_in_mode(kin: int, hd: Hd, conv: Conv, rng: np.random.Generator, length: float) -> list[float]:
    """Draw axis values as above that the inverse formula returns: carriages of 12 and 209 on their side."""
    for _ in range(10_000):
        axes = random_closing(kin, hd, conv, rng)
        pose = LOOPS[kin](hd, axes, length, conv)
        assert pose is not None
        found = LOOP_INVERSES[kin](hd, pose, length, conv)
        if any(differ(kin, one, axes) < 1e-6 for one in found):
            return axes
    raise AssertionError(f"KIN_TYP {kin} has no state in its mode: {hd}")


def differ(kin: int, found: Sequence[float], wanted: Sequence[float]) -> float:
    """Return the largest difference of two sets of axis values (mm, degrees), whole turns apart."""
    apart = np.subtract(found, wanted)
    rotary = {12: (), 21: (3,), 37: (0, 1, 2), 209: (3, 4)}[kin]
    for n in rotary:
        apart[n] = (apart[n] + 180.0) % 360.0 - 180.0
    return float(np.abs(apart).max())


def random_far(kin: int, hd: Hd, rng: np.random.Generator) -> tuple[dict[int, float], list[float]]:
    """Draw axis values at which the struts do not close: slides too far apart, rods of 37 too short at level levers."""
    axes, far = _anywhere(kin, hd, rng), dict(hd)
    if kin == 21:
        axes[1] = axes[0] + float(rng.choice([-1, 1])) * (hd[2] + hd[3] + 250.0)
    elif kin == 37:
        far[6] = round(0.8 * (hd[5] - hd[4] + hd[7]), 3)
        axes = [float(rng.uniform(-15.0, 15.0)) + hd[8 + n] for n in range(3)]
    else:
        axes[int(rng.integers(3))] += 3.0 * hd[7]
    return far, axes


def is_regular(kin: int, hd: Hd, axes: Sequence[float], conv: Conv, length: float, least: float = 3.0) -> bool:
    """Tell whether the inverse formula returns these axes and no other solution is nearer than `least`, mm or degrees.

    Where two solutions meet, digits are lost.
    """
    T = LOOPS[kin](hd, axes, length, conv)
    if T is None or (kin == 209 and abs(T[2, 2]) > 0.999):
        return False  # the table's C turns about the tool vector: any C is as good
    found = LOOP_INVERSES[kin](hd, T, length, conv)
    if not all(is_steady(kin, hd, one, conv) for one in found) or not any(differ(kin, a, axes) < 1e-6 for a in found):
        return False
    return all(differ(kin, one, other) > least for n, one in enumerate(found) for other in found[:n])


def random_regular(
    kin: int, hd: Hd, conv: Conv, rng: np.random.Generator, length: float, least: float = 3.0
) -> list[float]:
    """Draw axis values away from singular positions."""
    for _ in range(10_000):
        axes = random_closing(kin, hd, conv, rng)
        if is_regular(kin, hd, axes, conv, length, least):
            return axes
    raise AssertionError(f"KIN_TYP {kin} is singular everywhere: {hd}")


def circle(kin: int, hd: Hd, conv: Conv, rng: np.random.Generator, steps: int) -> np.ndarray:
    """Return a closed path (steps, n_axes) of axis values about a state, as wide as it stays regular."""
    middle = np.array(random_regular(kin, hd, conv, rng, 0.0, least=15.0))
    phase = np.linspace(0.0, 2.0 * np.pi, steps)[:, None] + rng.uniform(0.0, 2.0 * np.pi, len(middle))
    width = 60.0
    while not all(is_regular(kin, hd, row, conv, 0.0, least=15.0) for row in (middle + width * np.sin(phase))[::20]):
        width /= 2.0
    return middle + width * np.sin(phase)


def channel_list(kin: int, hd: Mapping[int, float]) -> str:
    """Return the list of a channel with this one type."""
    lines = [f"trafo[0].id {kin}"]
    for n, value in hd.items():
        lines.append(f"trafo[0].param[{n - 1}] {value if n in FLAGS[kin] else value / RAW_UNIT:.0f}")
    return "\n".join([*lines, "Ende", ""])


def read_hd(text: str, flags: frozenset[int] = frozenset()) -> dict[int, float]:
    """Return the HD values of a list with one kinematic."""
    hd = {}
    for line in text.splitlines():
        if ".param[" in line:
            key, value = line.split()
            n = int(key.split("param[")[1].rstrip("]")) + 1
            hd[n] = float(value) * (1.0 if n in flags else RAW_UNIT)
    return hd
