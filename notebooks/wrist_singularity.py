# %% [markdown]
# # Why A5 = 0 stops the robot
#
# **A six-axis arm draws a straight line at constant feed, well inside its reach and its limits. In the middle of the line it brakes, or
# the controller stops it with an alarm. The line is fine, the axes are fine. What happens at A5 = 0, and how close can one pass?**
#
# A KUKA KR 6 R900 with its forearm level, as the line passes in front of it:

# %%
from figures import drawing

import chainbuild

robot = chainbuild.Robot.load("kr6r900")
LEVEL = [0, -90, 90, 0, 0, 0]
drawing(robot, LEVEL, view="front")

# %% [markdown]
# ## Two axes in one line
#
# At A5 = 0 the flange continues the forearm: A4 and A6 turn about the same line. At any other A5 the two lines meet in the wrist point at that
# angle.

# %%
import numpy as np
import pinocchio as pin


def line_of(name, axes):
    """A point and the direction of a joint's axis, in the base."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.q(axes))
    number = robot.model.getJointId(name)
    joint = next(joint for joint in robot.chain.joints if joint.name == name)
    return data.oMi[number].translation, data.oMi[number].rotation @ joint.direction


for a5 in (0, 10, -40):
    axes = [20, -70, 80, 50, a5, 30]
    (p4, d4), (p6, d6) = line_of("A4", axes), line_of("A6", axes)
    between = np.degrees(np.arctan2(np.linalg.norm(np.cross(d4, d6)), d4 @ d6))
    print(f"A5 = {a5:3}°: the axes of A4 and A6 are {between:.3f}° apart")
    assert np.isclose(between, abs(a5), atol=1e-6)
    assert abs((p6 - p4) @ np.cross(d4, d6)) < 1e-12  # m: they meet
    if a5 == 0:
        assert np.linalg.norm(np.cross(p6 - p4, d4)) < 1e-12  # m: they are one

# %% [markdown]
# So where A5 = 0 the two undo each other, by any angle. One axis of six does nothing new: five are left for six freedoms.

# %%
still = robot.fk(LEVEL).homogeneous
for angle in (15, 80, 170):
    assert np.allclose(robot.fk([0, -90, 90, angle, 0, -angle]).homogeneous, still, atol=1e-12)
print("A4 = α, A6 = −α: the tool stays where it is")

values = np.linalg.svd(robot.jacobian(LEVEL), compute_uv=False)
print("rank of the Jacobian:", (values > 1e-9).sum())
assert (values > 1e-9).sum() == 5

# %% [markdown]
# ## What is lost
#
# To move sideways without turning the tool, A1 has to turn the arm, and the wrist has to turn the tool back about the vertical. With
# A4 = 0 the wrist's axis A5 lies level: none of its three axes is vertical. First A4 has to make a quarter turn. chainbuild
# names it, with the speed it costs:

# %%
report = chainbuild.examine(robot, [0, -90, 90, 0, 0.3, 0])
print(report.names[0].sentence)

# %% [markdown]
# ## By hand
#
# The wrist point passes axis 1 at the distance *R* = 25 + 420 mm, sideways with the feed *v*. Seen from above the forearm turns at
# *ψ̇* = *v* / *R*. The tool keeps its direction, which dips by *δ* below the forearm (that is A5 in the middle of the line). Seen along the
# forearm the tool points down by sin *δ* and, once the arm has turned by *ψ*, sideways by cos *δ* sin *ψ*. A4 is the angle between the two:
#
# tan A4 = sin *ψ* / tan *δ*, so that in the middle **dA4/dt = *v* / (*R* tan *δ*)**
#
# As *δ* goes to 0 this grows without bound. The Jacobian says the same:

# %%
R, FEED = 0.025 + 0.420, 0.100  # m, m/s


def axis_speeds(delta):
    """Axis speeds in °/s for a motion along Y of the base at the feed, with A5 = δ degrees in the middle."""
    axes = [0, -90, 90, 0, delta, 0]
    along_y = np.zeros(6)
    along_y[:3] = robot.fk(axes).rotation.T @ [0, FEED, 0]
    return np.degrees(np.linalg.solve(robot.jacobian(axes), along_y))


def by_hand(delta):
    return np.degrees(FEED / (R * np.tan(np.radians(delta))))


for delta in (10, 3, 1, 0.1, 0.001):
    speed = abs(axis_speeds(delta)[3])
    print(f"A5 = {delta:6g}°: A4 needs {speed:11.2f} °/s, by hand {by_hand(delta):11.2f}")
    assert np.isclose(speed, by_hand(delta), rtol=1e-6)

# %% [markdown]
# ## How close one can pass
#
# A4 does 381 °/s. Turned round, the formula says at which angle the line can still be driven with 100 mm/s, and that
# at A5 = 0 the only feed left is none. That is why the robot stops: not an error, but a speed that no axis has.

# %%
LIMIT = robot.axes[3].max_speed
smallest = np.degrees(np.arctan(FEED / (R * np.radians(LIMIT))))
print(f"A4 can do {LIMIT:g} °/s: A5 of {smallest:.3f}° at least for {1000 * FEED:g} mm/s")
assert np.isclose(abs(axis_speeds(smallest)[3]), LIMIT, rtol=1e-6)
others = np.delete(np.abs(axis_speeds(smallest)), [3, 5])
assert others.max() < 20  # the other axes but A6, which turns against A4, hardly move

# %% [markdown]
# `path_report` finds this along whole paths, between the rows of a table, too. The line of 300 mm with the tool dipping by
# 1°:

# %%
SIDE = np.sinh(np.linspace(-8, 8, 241)) / np.sinh(8) * 0.150  # m: closer in the middle


def line(delta):
    """Axis values along the line, with A5 = δ in its middle, on the branch that passes there."""
    middle = np.array([0, -90, 90, 0, delta, 0.0])
    poses = np.repeat(robot.fk(middle).homogeneous[None], len(SIDE), axis=0)
    poses[:, 1, 3] = SIDE
    half = len(SIDE) // 2
    after = robot.ik_path(poses[half:], start=middle)
    before = robot.ik_path(poses[half::-1], start=middle)
    assert after.success.all() and before.success.all()
    return np.vstack([before.axes[:0:-1], after.axes])


ROWS = {delta: line(delta) for delta in (10, 3, 1, 0.1)}
found = chainbuild.path_report(robot, ROWS[1], between="cp", options=chainbuild.PathOptions(feed_mm_min=6000))
for entry in found.speeds:
    needed, limit = entry.speed.needed, entry.speed.limit
    note = f"  at {entry.place.path_mm:.1f} mm: too much" if needed > limit else ""
    print(f"{entry.speed.name}: at most {needed:6.1f} of {limit:g} °/s{note}")
assert np.isclose(found.speeds[3].speed.needed, by_hand(1), rtol=1e-4)

# %% [markdown]
# ## Try it
#
# With a running kernel, drag A5 through 0, or the tool sideways by its green arrow, and watch A4.

# %%
chainbuild.show(robot, at=[0, -90, 90, 0, 3, 0])

# %% [markdown]
# ## The answer
#
# Left: A4 along the line. The closer it passes to A5 = 0, the more the half turn of A4 becomes a jump. Right: the speed that this takes at
# 100 mm/s. Above the limit of A4 the feed breaks down; at A5 = 0 it is zero. What helps is geometry, not a better controller: tilt the tool
# by 2°, lay the line higher or lower than the forearm, or let the axes move as they like there (PTP).

# %%
from figures import BLUE, COLOURS, INK, ORANGE, plot, svg

left, right = plot(860, 400, columns=2, right=30)
for (delta, rows), colour in zip(ROWS.items(), COLOURS, strict=False):
    left.plot(1000 * SIDE, rows[:, 3], color=colour, label=f"A5 = {delta:g}° in the middle")
left.set(
    xlabel="way along the line in mm",
    ylabel="A4 in °",
    xlim=(-150, 150),
    ylim=(-115, 100),
    yticks=[-90, -45, 0, 45, 90],
)
left.legend(loc="lower right", fontsize=9, frameon=False)
left.set_title("A4 along a straight line")

angles = np.geomspace(0.1, 30, 60)
right.loglog(angles, by_hand(angles), color=BLUE, label="v / (R tan A5)")
dots = np.array([0.1, 0.3, 1, 3, 10, 30])
right.loglog(dots, [abs(axis_speeds(dot)[3]) for dot in dots], "o", color=INK, label="Jacobian")
right.axhspan(LIMIT, 1e4, color=ORANGE, alpha=0.12)
right.axhline(LIMIT, color=ORANGE, linewidth=1.2)
right.plot([smallest, smallest], [10, LIMIT], color=ORANGE, linewidth=1.2, linestyle="--")
right.annotate("more than A4 can do", (28, 3500), color=ORANGE, ha="right")
right.annotate(f"{smallest:.1f}°", (smallest * 1.08, 13), color=ORANGE)
right.set(
    xlabel="A5 in the middle of the line in °", ylabel="speed of A4 at 100 mm/s in °/s", xlim=(0.1, 30), ylim=(10, 1e4)
)
right.set_xticks([0.1, 1, 10], ["0.1", "1", "10"])
right.set_yticks([10, 100, 1000, 10000], ["10", "100", "1000", "10 000"])
right.legend(loc="lower left", fontsize=9, frameon=False)
right.set_title("What it costs")
svg(left)
