# %% [markdown]
# # A robot on a linear unit at a turning table
#
# **A small robot reaches 0.9 m. The seam round the top of a box, 1.2 m long and 0.5 m wide, is 3.4 m. There is a linear unit under the robot, and a turning
# table under the box. How much of the seam does each of them bring within reach, and how do they move?**
#
# On a TwinCAT CNC this is one coupling kinematic (KIN_TYP 210) of three parts: the unit X, the robot (KIN_TYP 45, a KUKA KR 6 R900) on it, and
# the table C, to which the program refers (`workpiece_cs`).

# %%
import tempfile
from pathlib import Path

from figures import drawing

import chainbuild

LIST = """
trafo[0].id 210
trafo[0].group[0].name WELDER
trafo[0].group[0].chain[0] UNIT
trafo[0].group[0].chain[1] ROBOT
trafo[0].group[0].workpiece_cs TABLE
trafo[0].group[1].name TABLE
trafo[0].group[1].chain[0] TABLE
trafo[1].id 91
trafo[1].name UNIT
trafo[1].zero_orientation[2] 1.0
trafo[1].number_of_axes 1
trafo[1].chain[0] 0
trafo[1].axis[0].type 1
trafo[1].axis[0].orientation[0] 1.0
trafo[1].programming_mode 12
trafo[1].rtcp 1
trafo[2].id 45
trafo[2].name ROBOT
trafo[2].base[2] -3000000        # 300 mm above the unit
trafo[2].param[6] 4000000
trafo[2].param[7] 4550000
trafo[2].param[8] 4200000
trafo[2].param[9] 900000
trafo[2].param[10] 250000
trafo[2].param[11] -250000
trafo[2].param[13] -900000
trafo[2].param[14] 900000
trafo[2].param[20] 1
trafo[2].param[23] 1
trafo[2].param[25] 1
trafo[2].param[33] 4             # the torch points out of the flange
trafo[3].id 91
trafo[3].name TABLE
trafo[3].base[0] -20000000       # beside the unit, at X 2000, Y 1100, Z 500 mm
trafo[3].base[1] -11000000
trafo[3].base[2] -5000000
trafo[3].zero_orientation[2] 1.0
trafo[3].number_of_axes 1
trafo[3].chain[0] 0
trafo[3].axis[0].type 2
trafo[3].axis[0].orientation[2] -1.0   # carries the workpiece: multiplied by -1
trafo[3].programming_mode 12
trafo[3].rtcp 1
"""
OVERLAY = """
name = "Welding cell"

[limits]
X = [1000, 3000]
C1 = [-170, 170]
B1 = [-190, 45]
B2 = [-120, 156]
A1 = [-185, 185]
B3 = [-120, 120]
A2 = [-350, 350]
C = [-400, 400]

[geometry]
table_mm = 900
part_mm = [1200, 500, 100]
"""
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "cell.lis"
    path.write_text(LIST)
    path.with_suffix(".chainbuild.toml").write_text(OVERLAY)
    machine = chainbuild.load(path)
robot = chainbuild.Robot(machine.chain(tool_length_mm=100.0))
drawing(robot, [2000, -90, -60, 100, 0, 50, 90, 0], frames=True)

# %% [markdown]
# ## Where the table stands
#
# The manuals leave open in which direction a `base` offset counts. chainbuild says where the parts stand as it reads the file, and asks to verify it
# at the machine.

# %%
for finding in robot.chain.findings:
    print(finding.code, finding.text)
print([axis.name for axis in robot.axes])

# %% [markdown]
# ## The program
#
# The seam in the workpiece frame, every 20 mm, with the torch upright. In this frame the program stays the same whoever moves.

# %%
from itertools import pairwise

import numpy as np

LONG, WIDE, HIGH = 1.2, 0.5, 0.1  # m
CORNERS = np.array([[-LONG, -WIDE], [LONG, -WIDE], [LONG, WIDE], [-LONG, WIDE], [-LONG, -WIDE]]) / 2

points, sides = [], []
for side, (begin, end) in enumerate(pairwise(CORNERS)):
    for share in np.arange(0, 1, 0.02 / np.linalg.norm(end - begin)):
        points.append(begin + share * (end - begin))
        sides.append(side)
points, sides = np.array(points), np.array(sides)


def torch(point, facing):
    """Torch down at a point of the seam, its X along the side whose outward normal is at so many degrees."""
    c, s = np.cos(np.radians(facing + 90)), np.sin(np.radians(facing + 90))
    T = np.eye(4)
    T[:3, :3] = np.array([[c, s, 0], [s, -c, 0], [0, 0, -1]])
    T[:3, 3] = *point, HIGH
    return T


NORMALS = np.array([-90, 0, 90, 180])  # degrees: of the four sides
seam = np.array([torch(p, NORMALS[s]) for p, s in zip(points, sides, strict=True)])
print(f"{len(seam)} points, {0.02 * len(seam):.2f} m")

# %% [markdown]
# ## The robot alone
#
# Unit in the middle, table still. With X and C held the other six axes have a closed form, and every point is answered at once.

# %%
alone = robot.ik_batch(seam, held={"X": 2000, "C": 0}).success
print(f"robot alone: {0.02 * alone.sum():.2f} m of {0.02 * len(seam):.2f} m")

# %% [markdown]
# **By hand.** The torch is upright, so that the wrist stands 180 mm (flange and torch) above the seam: at 500 + 100 + 180 = 780 mm, 80 mm above the
# shoulder at 300 + 400. Upper arm 455 and forearm √(420² + 25²) reach the wrist up to 25 + √((455 + 420.7)² − 80²) = 897 mm away from axis 1. (On this
# R900-2 the forearm lies 25 mm beside the elbow.)

# %%
forearm = np.hypot(0.420, 0.025)
REACH = 0.025 + np.sqrt((0.455 + forearm) ** 2 - 0.080**2)
away = np.hypot(points[:, 0], 1.1 + points[:, 1])  # from axis 1, unit opposite the middle
print(f"reach {1000 * REACH:.1f} mm: agrees at every point: {(alone == (away <= REACH)).all()}")
assert (alone == (away <= REACH)).all()

# %% [markdown]
# ## With the linear unit
#
# The unit stands opposite the point: then only the distance across it counts. The long side in front is reached, and what little of the short sides lies within
# 897 mm. The far side is 1350 mm away: no stroke helps.

# %%
OPPOSITE = 2000 + 1000 * points[:, 0]
unit = np.array([robot.ik(T, held={"X": x, "C": 0}).success for T, x in zip(seam, OPPOSITE, strict=True)])
print(f"with the unit: {0.02 * unit.sum():.2f} m")
assert (unit == (1.1 + points[:, 1] <= REACH)).all()

# %% [markdown]
# ## With the table
#
# The table turns each side to the front, and at the corners by 90° while the torch stays on the corner. A point of the box then stands in the
# room at the table's centre + *R*(C)·point; the unit follows it. Is it +C or −C? Ask the model, not the drawing:

# %%
home = [2000.0, -90, -60, 100, 0, 50, 90, 0]
here, turned = robot.fk(home), robot.fk([*home[:7], 90])
print(
    "the torch stands still; on the box it moves from",
    (1000 * here.translation[:2]).round(1) + 0.0,
    "to",
    (1000 * turned.translation[:2]).round(1) + 0.0,
)
assert np.allclose(
    turned.translation[:2], np.array([[0, 1], [-1, 0]]) @ here.translation[:2], atol=1e-9
)  # seen turned by −90°

# %% [markdown]
# The box turns by +C. A side with its normal at *n* faces the robot, which is at −90°, when C = −90° − *n*.

# %%
program, table = [], []
for side in range(4):
    program += list(seam[sides == side])
    table += [-90.0 * side] * int((sides == side).sum())
    for swing in np.linspace(0, 90, 31)[
        1:-1
    ]:  # the corner: the torch turns with the box, and keeps its direction in the room
        program.append(torch(CORNERS[side + 1], NORMALS[side] + swing))
        table.append(-90.0 * side - swing)
program, table = np.array([*program, torch(CORNERS[-1], 270)]), np.array([*table, -360.0])
assert np.allclose(np.diff(table)[np.diff(table) != 0], -3.0)


def in_the_room(point, c):
    c = np.radians(c)
    return np.array([[np.cos(c), -np.sin(c)], [np.sin(c), np.cos(c)]]) @ point + [2.0, 1.1]


rows = [np.array([1400.0, -90, -60, 100, 0, 50, 90, 0])]
for T, c in zip(program, table, strict=True):
    x = 1000 * in_the_room(T[:2, 3], c)[0]
    found = robot.ik(T, start=rows[-1], held={"X": x, "C": c})
    assert found.success, found.reason
    rows.append(found.axes)
rows = np.array(rows[1:])
print(f"with the table: all {0.02 * len(seam):.2f} m, in {len(rows)} rows")

# %% [markdown]
# The proof is forward kinematics: the torch is where the program says, in the workpiece frame, in every row. And see what is left for the robot. With the unit
# opposite and the side in front it works in one plane: C1, A1 and A2 stand still all the way round, the other three only change the distance.

# %%
poses = robot.fk_batch(rows)
print(f"within a micrometre: {np.abs(poses - program).max() < 1e-6}")
assert np.abs(poses - program).max() < 1e-6

for axis, low, high in zip(robot.axes, rows.min(axis=0).round(6) + 0.0, rows.max(axis=0).round(6) + 0.0, strict=True):
    print(f"{axis.name:2}: {low:8.1f} … {high:8.1f} {axis.unit}")
assert np.ptp(rows[:, [1, 4, 6]], axis=0).max() < 1e-4  # C1, A1, A2
assert np.abs(np.diff(rows[:, 1:], axis=0)).max() < 12  # degrees from row to row: no branch is changed

# %% [markdown]
# ## The cell at a corner
#
# The torch is on the corner that is just being turned round. Its way over the box is the whole seam.

# %%
corner = int(np.flatnonzero(table == -45.0)[0])
drawing(robot, rows[corner], path_axes=rows)

# %% [markdown]
# ## The answer
#
# Left: the seam from above, with the robot below, and who is needed for which part of it. Right: how unit and table move along it. The table turns at the corners
# only, while the torch stands on one; the unit runs to and fro.

# %%
from figures import BLUE, GREY, INK, ORANGE, SKY, plot, svg

left, right = plot(900, 420, columns=2, right=70)
for reached, colour, label, width in (
    (np.ones(len(points), bool), ORANGE, "with the table", 4),
    (unit, SKY, "with the unit", 8),
    (alone, BLUE, "robot alone", 12),
):
    left.plot(
        *(1000 * points[reached].T), ".", color=colour, markersize=width, label=f"{label}: {0.02 * reached.sum():.2f} m"
    )
angle = np.radians(np.linspace(30, 150, 60))
left.plot(1000 * REACH * np.cos(angle), 1000 * (REACH * np.sin(angle) - 1.1), color=GREY, linewidth=1.2, linestyle="--")
left.annotate("reach, unit in the middle", (0, -190), color=GREY, ha="center", fontsize=9)
left.plot([-1000, 1000], [-1100, -1100], color=INK, linewidth=3)
left.plot(0, -1100, "s", color=INK, markersize=13)
left.annotate("unit", (1000, -1075), ha="right")
left.set(
    xlabel="x of the box in mm", ylabel="y of the box in mm", aspect="equal", xlim=(-1050, 1050), ylim=(-1200, 700)
)
left.set_xticks([-1000, -500, 0, 500, 1000])
left.legend(loc="lower left", bbox_to_anchor=(0.0, 0.12), fontsize=9, frameon=False, handletextpad=0.2)
left.set_title("Who is needed where")

way = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(program[:, :2, 3], axis=0), axis=1))])
right.plot(way, rows[:, 0], color=SKY)
right.set(xlabel="way along the seam in m", ylabel="X of the unit in mm", xlim=(0, way[-1] + 0.05), ylim=(1000, 3000))
other = right.twinx()
other.plot(way, rows[:, 7], color=ORANGE)
other.set(ylabel="C of the table in °", ylim=(-450, 90), yticks=[-360, -270, -180, -90, 0])
other.grid(visible=False)
right.annotate("X", (0.15, 1720), color=SKY, fontsize=13)
other.annotate("C", (2.6, -240), color=ORANGE, fontsize=13)
right.set_title("How unit and table move")
svg(left)
