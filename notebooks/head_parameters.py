# %% [markdown]
# # What every HD of a head does
#
# **A mill with a C/A head keeps its tool tip in place while the head turns: the transformation moves X, Y and Z along. The
# dial gauge at the tip says that it wanders. Which of the nine numbers of the head is wrong, and by how much?**
#
# This is KIN_TYP 9 of TwinCAT CNC. Its head data HD1 … HD9 are given here so that each has something to do.

# %%
import tempfile
from pathlib import Path

import chainbuild

LIST = """
trafo[0].id 9
trafo[0].param[0] 1800000   # HD1, in 0.1 µm
trafo[0].param[1] 3000000   # HD2
trafo[0].param[4]  600000   # HD5
trafo[0].param[5]  400000   # HD6
trafo[0].param[6]  900000   # HD7
trafo[0].param[7] -700000   # HD8
trafo[0].param[8]  500000   # HD9
"""
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "head.lis"
    path.write_text(LIST)
    machine = chainbuild.load(path)

TOOL = 120.0  # mm, from the clamping point to the tip
robot = chainbuild.Robot(machine.chain(tool_length_mm=TOOL))
for row in chainbuild.catalogue()[9].data.hd:
    print(f"HD{row.n} {row.name:12} {row.unit:4} {row.meaning.split(';')[0].split(',')[0]}")

# %%
from figures import drawing

drawing(robot, [0, 0, 0, 30, 60], view="detail", dimensions=chainbuild.dimensions(machine))

# %% [markdown]
# ## One number longer by 1 mm
#
# Where does the tip go if one HD grows by 1 mm (an angle by 1°) and no axis moves? That is a column of numbers for every
# position of the head. It is asked of the model, by building it again with one number changed.

# %%
import numpy as np

geometry = {datum.symbol: datum for datum in machine.geometry() if datum.symbol.startswith("HD")}
HDS = [f"HD{n}" for n in range(1, 10)]


def tip(data, c, a, tool=TOOL):
    """Tip in mm with all linear axes at 0; `data`: HD → change in mm or degrees."""
    changed = machine.with_values({geometry[hd]: geometry[hd].value + by for hd, by in data.items()})
    return 1000 * chainbuild.Robot(changed.chain(tool_length_mm=tool)).fk_batch(rows(c, a))[:, :3, 3]


def rows(c, a):
    """Axis values X, Y, Z, C, A with the head at angles in degrees."""
    c, a = np.broadcast_arrays(np.atleast_1d(c), a)
    zero = np.zeros_like(c, dtype=float)
    return np.column_stack([zero, zero, zero, c, a])


def effect(hd, c, a, tool=TOOL, by=1.0):
    return tip({hd: by}, c, a, tool) - tip({}, c, a, tool)


print("tip moves [mm] at    C 0  A 0             C 90  A 0            C 0  A 90")
for hd in HDS:
    moves = np.round([effect(hd, c, a)[0] for c, a in ((0, 0), (90, 0), (0, 90))], 9) + 0.0
    print(f"{hd} + 1 {geometry[hd].unit:5}", *(f"({x:5.2f} {y:5.2f} {z:5.2f})" for x, y, z in moves), sep="  ")

# %% [markdown]
# ## Three families
#
# A length belongs to one of three rigid parts, and its column turns as that part does. Written by hand, with *R* for the turn
# about C and *Q* for the tilt about A:
#
# | part | numbers | the tip moves by |
# |---|---|---|
# | slide, turns with nothing | HD7, HD8 | *e*<sub>x</sub>, *e*<sub>y</sub> |
# | fork, turns with C | HD5, HD6, HD2 | *R*(−*e*<sub>y</sub>), *R*(−*e*<sub>x</sub>), −*e*<sub>z</sub> |
# | spindle, turns with C and A | HD9, HD1 | *RQ*(−*e*<sub>y</sub>), *RQ*(−*e*<sub>z</sub>) |
#
# HD2 lies along C itself, so that turning does not show it. The table is what the model does, in every position:

# %%
rng = np.random.default_rng(4)
angles = rng.uniform([-180, -100], [180, 100], size=(50, 2))


def about_z(t):
    return np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]])


def about_x(t):
    return np.array([[1, 0, 0], [0, np.cos(t), -np.sin(t)], [0, np.sin(t), np.cos(t)]])


ex, ey, ez = np.eye(3)
BY_HAND = {
    "HD7": lambda R, Q: ex,
    "HD8": lambda R, Q: ey,
    "HD5": lambda R, Q: -R @ ey,
    "HD6": lambda R, Q: -R @ ex,
    "HD2": lambda R, Q: -ez,
    "HD9": lambda R, Q: -R @ Q @ ey,
    "HD1": lambda R, Q: -R @ Q @ ez,
}
for hd, law in BY_HAND.items():
    hand = [law(about_z(c), about_x(a)) for c, a in np.radians(angles)]
    assert np.allclose(effect(hd, *angles.T), hand, atol=1e-9), hd
print("as in the table at", len(angles), "positions:", ", ".join(BY_HAND))

# %% [markdown]
# ## What a dial gauge can see
#
# The gauge is set to zero at C = A = 0. It then shows only how much the effect *changes*. HD2, HD7 and HD8 change nothing: they
# are found by measuring where the head is in the machine, never by turning it.

# %%
ROUND = [(c, a) for a in (0, 45, 90) for c in range(0, 360, 30)]  # 36 readings


def readings(hd, tool=TOOL, by=1e-3):
    """What the gauge shows for one mm or degree, at all positions, in one column."""
    moves = effect(hd, *np.array(ROUND, dtype=float).T, tool, by) / by
    return (moves - moves[0]).ravel()


silent = [hd for hd in HDS if np.abs(readings(hd)).max() < 1e-6]
print("not seen by turning the head:", ", ".join(silent))
assert silent == ["HD2", "HD7", "HD8"]

# %% [markdown]
# The other six are not independent either. Rank 5: with one tool, a wrong zero of A (HD3) cannot be told from a
# spindle that sits beside its axis (HD9) and is a little too long (HD1). A second tool of another length can tell, since only the
# angle's effect grows with it.

# %%
seen = [hd for hd in HDS if hd not in silent]
one_tool = np.column_stack([readings(hd) for hd in seen])
two_tools = np.vstack([one_tool, np.column_stack([readings(hd, tool=220.0) for hd in seen])])


def rank(table):
    """Independent columns, whatever their units."""
    return np.linalg.matrix_rank(table / np.linalg.norm(table, axis=0), tol=1e-4)


print(f"rank of {len(seen)} columns: {rank(one_tool)} with one tool, {rank(two_tools)} with two")
assert (rank(one_tool), rank(two_tools)) == (5, 6)

lever = 180 + TOOL  # HD1 and the tool, turned by a degree about A; HD9 is 50
assert np.allclose(readings("HD3"), np.radians(lever * readings("HD9") - 50 * readings("HD1")), atol=1e-4)

# %% [markdown]
# ## Finding the wrong one
#
# On this machine HD5 is really 60.30 mm, while the data say 60. Here are the gauge's readings, in 0.01 mm as it shows them. Each
# number is given the change that explains them best:

# %%
true = tip({"HD5": 0.30}, *np.array(ROUND, dtype=float).T) - tip({}, *np.array(ROUND, dtype=float).T)
gauge = np.round(true - true[0], 2).ravel()
print(f"the tip wanders by up to {np.linalg.norm(gauge.reshape(-1, 3), axis=1).max():.2f} mm")

left = {}
for hd in seen:
    column = readings(hd)
    change = column @ gauge / (column @ column)
    left[hd] = np.abs(gauge - change * column).max()
    print(f"{hd} {change:+.3f} {geometry[hd].unit}: leaves {left[hd]:.3f} mm")
assert min(left, key=left.get) == "HD5"
assert left.pop("HD5") < 0.01  # the last digit of the gauge
assert min(left.values()) > 0.3

# %% [markdown]
# ## The answer: nine fingerprints
#
# Seen from above: the way of the tip while C makes a full turn, with one number 1 mm too large (an angle 0.2°). The dot is at C = 0.
# A circle that all three tilts share belongs to the fork; circles that grow or shrink with the tilt to the spindle or to an angle; a
# dot that stays has to be measured otherwise. `chainbuild crosscheck` does this search with poses read off the control.

# %%
from figures import BLUE, ORANGE, SKY, plot, svg

panels = plot(760, 800, rows=3, columns=3, right=16)
turn = np.linspace(0, 360, 73)
for hd, ax in zip(HDS, panels.flat, strict=True):
    size = 0.2 if geometry[hd].unit == "deg" else 1.0
    for a, colour, width in ((0, BLUE, 5.0), (45, SKY, 3.0), (90, ORANGE, 1.4)):
        way = effect(hd, turn, a, by=size)
        ax.plot(way[:, 0], way[:, 1], color=colour, linewidth=width, label=f"A = {a}°")
        ax.plot(*way[0, :2], "o", color=colour, markersize=4 + width)
    ax.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    ax.set_title(f"{hd} + {size:g} {geometry[hd].unit}".replace(" deg", "°"))
    ax.set(xlabel="X in mm", ylabel="Y in mm")
panels[0, 1].legend(loc="lower center", fontsize=9, frameon=False)
svg(panels[0, 0])
