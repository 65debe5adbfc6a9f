# %% [markdown]
# # The limits of a parallelogram, by collision
#
# **Axis 3 of a heavy arm is driven by a crank at the shoulder and a rod up to the elbow. The control watches one angle between the two
# arms, with two limits in the machine data (MD62964): here 30° and 150°, as on an older machine. Do crank and rod stay clear of the arm
# and the column inside them? What is given away?**

# %%
from figures import drawing

import chainbuild

drawing(chainbuild.Robot.load("parallelogram_nr"), [0, 0, -90, 0, 0, 0])

# %% [markdown]
# ## The bodies
#
# Machine data know axes, not castings. What may collide is said in the overlay beside the file: here plain capsules, measured at
# the machine (these are invented), and a crank of 300 mm with a rod 40 mm in radius, which moves in the plane of the arms.

# %%
import shutil
import tempfile
from pathlib import Path

BODIES = """
[geometry]
rods = true
crank_mm = 300
rod_radius_mm = 40

[geometry.shapes]
base = [{capsule = [0, 0, 100, 0, 0, 450], radius_mm = 200}]
A1_link = [{capsule = [-50, 0, -350, 300, 0, -350], radius_mm = 120}]
A2_link = [{capsule = [0, 0, 0, 1100, 0, 0], radius_mm = 90}]
A3_link = [{capsule = [0, 0, 0, 1250, 0, 250], radius_mm = 100}, {capsule = [0, 0, 0, -294.2, 0, -58.8], radius_mm = 40}]
"""
shipped = Path(chainbuild.load("parallelogram_nr").path)
with tempfile.TemporaryDirectory() as folder:
    copy = Path(shutil.copy(shipped, folder))
    overlay = shipped.with_suffix(".chainbuild.toml").read_text()
    copy.with_suffix(".chainbuild.toml").write_text(overlay + BODIES)
    robot = chainbuild.Robot.load(copy)
drawing(robot, [0, 0, -90, 0, 0, 0], view="front")

# %% [markdown]
# ## The angle that is watched
#
# Crank and forearm stay parallel, rod and upper arm as well: the four pins are a parallelogram at every position. The control's angle is
# A2 + A3 + 180° on this arm. Seen at the elbow it lies between upper arm and forearm, 0° folded, measured to the forearm's own X; the pins
# of rod and elbow lie 11.31° beside that, since the forearm's wrist is 250 mm beside 1250 mm.

# %%
import numpy as np
import pinocchio as pin

SKEW = np.degrees(np.arctan2(250, 1250))


def pins(axes):
    """Shoulder, elbow, lower and upper pin of the rod, in the base."""
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.q(axes))
    joints = [data.oMi[model.getJointId(name)].translation for name in ("A2", "A3", "rod")]
    upper = data.oMf[model.getFrameId("rod_pin")].translation
    rod_end = data.oMf[model.getFrameId("rod_end")].translation
    assert np.allclose(upper, rod_end, atol=1e-12)  # the rod reaches the forearm's pin
    return *joints, upper


rng = np.random.default_rng(2)
for a2, angle in zip(rng.uniform(-60, 75, 50), rng.uniform(10, 150, 50), strict=True):
    shoulder, elbow, lower, upper = pins([rng.uniform(-180, 180), a2, angle - 180 - a2, 0, 0, 0])
    assert np.allclose(lower - shoulder, upper - elbow, atol=1e-12)  # a parallelogram
    arm, lever = shoulder - elbow, upper - elbow
    cosine = arm @ lever / np.linalg.norm(arm) / np.linalg.norm(lever)
    assert np.isclose(180 - np.degrees(np.arccos(cosine)), angle + SKEW, atol=1e-6)
print(
    f"a parallelogram of {1000 * np.linalg.norm(arm):.0f} and {1000 * np.linalg.norm(lever):.0f} mm, skew {SKEW:.2f}°"
)

# %% [markdown]
# ## One position
#
# coal, Pinocchio's library for collisions, tells which bodies are nearest. At the lower limit of the file, 30°, all is well; at its upper limit
# with the arm leant back it is not:

# %%
collision = chainbuild.CollisionModel(robot)


def at(a2, angle):
    return [0, a2, angle - 180 - a2, 0, 0, 0]


for a2, angle in ((0, 30), (0, 110), (-30, 110)):
    nearest = collision.nearest(at(a2, angle))
    state = "free" if nearest.distance > 0 else "COLLIDES"
    print(f"A2 = {a2:3}°, angle {angle:3}°: {state:8}  {' – '.join(nearest.pair)}, {1000 * nearest.distance:.1f} mm")
assert not collision.collides(at(0, 110))
assert collision.collides(at(-30, 110))

# %%
drawing(robot, at(-30, 110), view="front")

# %% [markdown]
# ## Every position of axis 2
#
# `swept_limits` moves A2 over its range and finds at each value how far the angle is free, to a thousandth of a degree.

# %%
report = chainbuild.swept_limits(robot)
for interval in report.intervals[::12]:
    print(
        f"A2 = {interval.over:6.2f}°: {interval.lower:.2f}° ({' – '.join(interval.lower_pair)})"
        f" … {interval.upper:.2f}° ({' – '.join(interval.upper_pair)})"
    )

# %% [markdown]
# ## By hand
#
# Two triangles are enough. The **rod** runs beside the **upper arm** at the distance 300 sin *γ*, with *γ* = angle + 11.31° between crank and arm. They
# touch at 40 + 90 mm, on both sides. The **crank's end** comes down on the **column**, whose upper body lies 350 mm below the shoulder, when it has dropped
# by 350 − (40 + 120) mm; that depends on how the crank stands in the room, and so moves with A2.

# %%
touching = np.degrees(np.arcsin((40 + 90) / 300))
dropped = np.degrees(np.arcsin((350 - (40 + 120)) / 300))


def by_hand(a2):
    return touching - SKEW, min(180 - touching - SKEW, 90 + dropped - SKEW + a2)


apart = [
    max(abs(interval.lower - by_hand(interval.over)[0]), abs(interval.upper - by_hand(interval.over)[1]))
    for interval in report.intervals
]
print(f"{len(apart)} intervals by coal agree with the triangles within 0.002°: {max(apart) < 0.002}")
assert max(apart) < 0.002

# %% [markdown]
# ## The verdict
#
# One pair of limits has to hold at every A2, so that the tightest value decides.

# %%
for sentence in report.verdicts:
    print("-", sentence)
print("\n".join(report.machine_data()))
inwards = report.proposal[0] - by_hand(0)[0], by_hand(-60)[1] - report.proposal[1]
assert 0 <= min(inwards) <= max(inwards) < 0.02

# %% [markdown]
# ## The answer
#
# The free angle over A2: lines by hand, dots by coal. The file's upper limit lies above the edge at every A2: it never protects. Up to 25° of A2 the rod
# runs into the column first, beyond that into the arm. The strip below its lower limit is given away. Two numbers cannot do justice to
# the slanting edge: where a cell keeps A2 above −30°, the upper limit may be 87.98° instead of 57.98°.

# %%
from figures import BLUE, GREEN, INK, ORANGE, plot, svg

ax = plot(760, 460, right=150)
over = np.array([interval.over for interval in report.intervals])
low = np.array([interval.lower for interval in report.intervals])
high = np.array([interval.upper for interval in report.intervals])
ax.fill_between(over, low, high, color=GREEN, alpha=0.16, linewidth=0)
corner = (180 - touching) - (90 + dropped)  # A2 at which the rod meets both
ax.plot([-60, corner], [by_hand(-60)[1], by_hand(corner)[1]], color=ORANGE)
ax.plot([corner, 75], [by_hand(corner)[1], by_hand(75)[1]], color=BLUE)
ax.plot([-60, 75], [by_hand(-60)[0]] * 2, color=BLUE)
ax.plot(np.tile(over, 2), np.append(low, high), ".", color=INK, markersize=5)
assert 87.98 < by_hand(-30)[1] < 87.99
for limit in report.given:
    ax.axhline(limit, color=INK, linewidth=1.4, linestyle="--")
    ax.annotate(f"file: {limit:g}°", (77, limit), va="center", annotation_clip=False)
for limit in report.proposal:
    ax.axhline(limit, color=GREEN, linewidth=1.4)
    ax.annotate(f"proposed: {limit:.2f}°", (77, limit), va="center", color=GREEN, annotation_clip=False)
ax.annotate("rod meets the arm", (74, 134), color=BLUE, ha="right")
ax.annotate("rod meets the arm", (-58, 4), color=BLUE)
ax.annotate("rod meets\nthe column", (-22, 118), color=ORANGE, ha="right")
ax.annotate("free", (38, 90), color=GREEN, ha="center", fontsize=13)
ax.set(
    xlabel="A2 in ° (upright at 0, forwards positive)",
    ylabel="angle between the arms in °",
    xlim=(-60, 75),
    ylim=(0, 180),
)
ax.set_yticks(range(0, 181, 30))
ax.set_title("Where the parallelogram is free")
svg(ax)
