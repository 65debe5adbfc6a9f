"""Linear axes for displayed poses of RTCP machines, over arrays; `python -m tests.bench.displayed` writes the page."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

import chainbuild
from tests.bench.measure import per_item
from tests.bench.tables import markdown

MACHINES = ("ca_head_kin9", "ac_table_kin58", "bed_mill_kin1", "b_head_a_table_kin61", "ba_head_c_table_kin82")
POSES = 200_000
MARKS_US = {"compiled": 0.5, "NumPy": 5.0}


def measured(name: str) -> tuple[object, ...]:
    """Return a machine's name and its times [µs a pose] of both twins, after a check that the axes come back."""
    robot, rng = chainbuild.Robot.load(name), np.random.default_rng(0)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    axes = lower + (upper - lower) * rng.random((POSES, len(lower)))
    T = robot.fk_batch(axes)
    shown = {f"{letter}_mm": 1000.0 * T[:, n, 3] for n, letter in enumerate("xyz")}
    shown |= {robot.axes[n].name: axes[:, n] for n in robot.chain.display.axes}
    times = []
    for compiled in (True, False):
        assert np.abs(robot.from_display_batch(shown, compiled=compiled).axes - axes).max() < 1e-8
        times.append(per_item(partial(robot.from_display_batch, shown, compiled=compiled), POSES, 5))
    return name, *(f"{time:.2f}" for time in times)


def main() -> None:
    """Measure and write the table."""
    marks = " and ".join(f"{limit:g} µs {word}" for word, limit in MARKS_US.items())
    rows = [measured(name) for name in MACHINES]
    text = f"# Linear axes for displayed poses\n\nµs a pose over {POSES} poses, one core. Marks: {marks}.\n\n"
    text += markdown(("machine", *MARKS_US), rows) + "\n"
    Path(__file__).with_suffix(".md").write_text(text, "utf-8")
    print(text)


if __name__ == "__main__":
    main()
