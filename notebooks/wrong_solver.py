# %% [markdown]
# # Finding a wrong analytic solver
#
# **Somebody hands you closed-form inverse kinematics of a KUKA KR 6 R900, forty lines of sines, with a test that passes: forward, inverse, and
# back to the same numbers. Does it move the robot to where it should go? And if not, which line is wrong?**
#
# Here it is, as such code is written: the wrist point, then shoulder and elbow in a plane, then the wrist's angles.

# %%
import numpy as np

COLUMN, SHOULDER, UPPER, FOREARM, OFFSET, FLANGE = 0.400, 0.025, 0.455, 0.420, 0.035, 0.080  # m, from the data sheet


def rx(t):
    c, s = np.cos(t), np.sin(t)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def ry(t):
    c, s = np.cos(t), np.sin(t)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def rz(t):
    c, s = np.cos(t), np.sin(t)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


REST = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # flange at zero: z forwards, x down
REACH = np.hypot(FOREARM, OFFSET)
KINK = -np.arctan2(OFFSET, FOREARM)  # from the forearm's direction to the line elbow – wrist


def inverse(T, kink=KINK, sides=(1,)):
    """Rows of A1 … A6 in degrees for a pose (4, 4) in metres."""
    T = np.asarray(T)
    wrist = T[:3, 3] - FLANGE * T[:3, 2]
    found = []
    for side in sides:  # 1: the arm reaches forwards, -1: over its back
        turn = np.arctan2(side * wrist[1], side * wrist[0])
        x, z = side * np.hypot(wrist[0], wrist[1]) - SHOULDER, wrist[2] - COLUMN
        cosine = (x * x + z * z - UPPER**2 - REACH**2) / (2 * UPPER * REACH)
        if abs(cosine) > 1:
            continue
        for bend in (np.arccos(cosine), -np.arccos(cosine)):
            rise = np.arctan2(z, x) + np.arctan2(REACH * np.sin(bend), UPPER + REACH * np.cos(bend))
            pitch = rise - bend - kink  # of the forearm
            W = (rz(turn) @ ry(-pitch)).T @ T[:3, :3] @ REST.T
            for tilt in (np.arccos(np.clip(W[0, 0], -1, 1)), -np.arccos(np.clip(W[0, 0], -1, 1))):
                sign = np.sign(tilt) or 1.0
                roll4 = np.arctan2(sign * W[1, 0], -sign * W[2, 0])
                roll6 = np.arctan2(sign * W[0, 1], sign * W[0, 2])
                found.append(np.degrees([-turn, -rise, rise - pitch, -roll4, tilt, -roll6]))
    return found


def forward(axes, kink=KINK):
    """Pose (4, 4) in metres of A1 … A6 in degrees."""
    turn, rise, bend, roll4, tilt, roll6 = np.radians(axes) * [-1, -1, 1, -1, 1, -1]
    pitch = rise - bend
    x = SHOULDER + UPPER * np.cos(rise) + REACH * np.cos(pitch + kink)
    z = COLUMN + UPPER * np.sin(rise) + REACH * np.sin(pitch + kink)
    T = np.eye(4)
    T[:3, :3] = rz(turn) @ ry(-pitch) @ rx(roll4) @ ry(tilt) @ rx(roll6) @ REST
    T[:3, 3] = rz(turn) @ [x, 0, z] + FLANGE * T[:3, 2]
    return T


for answer in inverse(forward([0, -90, 90, 0, 30, 0])):
    print(answer.round(3) + 0.0)

# %% [markdown]
# ## Its own test passes
#
# Fifty positions: forward, inverse, forward. To rounding, every answer leads back to the pose.

# %%
import chainbuild

machine = chainbuild.load("kr6r900")
robot = chainbuild.Robot(machine.chain())
limits = np.array([[axis.lower, axis.upper] for axis in robot.axes])
rows = np.random.default_rng(5).uniform(*limits.T, size=(50, 6))


def round_trip(**how):
    kink = how.get("kink", KINK)
    poses = [forward(row, kink) for row in rows]
    return max(np.abs(forward(a, kink) - T).max() for T in poses for a in inverse(T, **how))


print(f"the round trip closes: {round_trip() < 1e-9}")
assert round_trip() < 1e-9

# %% [markdown]
# ## Against the machine data
#
# A round trip only proves that two functions are each other's inverse. `crosscheck` compares with the model that was built from the controller's
# data, which nobody derived by hand. First the forward half:

# %%
options = chainbuild.CheckOptions(count=15)
check = chainbuild.crosscheck(robot, forward, options=options, machine=machine)
print(f"{check.forward.agrees.sum()} of {len(check.forward.agrees)} poses agree")
miss = 1000 * check.forward.position_error
print(f"the tip is {miss.min():.3f} … {miss.max():.3f} mm off")
assert not check.agrees

# %% [markdown]
# It says more: which single datum would make both agree. The code is a correct solver of another robot, one whose forearm lies
# *below* its elbow.

# %%
for datum in check.deciding_data:
    for changed, value in datum.values.items():
        print(
            f"{changed.name}: {changed.value:g} to {value:g} {changed.unit} (leaves {1000 * datum.position_error:.6f} mm)"
        )
assert len(check.deciding_data) == 1

# %% [markdown]
# The line is `KINK`: the line from the elbow to the wrist rises above the forearm, by + arctan(35/420). The miss is
# what two signs make of 35 mm, in every position:

# %%
assert np.allclose(miss, 2 * 35, atol=1e-6)


def forward_mended(axes):
    return forward(axes, -KINK)


check = chainbuild.crosscheck(robot, forward_mended, options=options)
print(check)
assert check.agrees

# %% [markdown]
# ## The other half
#
# With the sign put right, the inverse gives no wrong answer any more. But it does not give all: this arm has up to eight.


# %%
def inverse_mended(T):
    return inverse(T, -KINK)


check = chainbuild.crosscheck(robot, inverse_mended, options=options)
inside = check.inverse
print(f"answers {inside.theirs}, wrong {inside.wrong}, poses without any answer {inside.unanswered}")
print(f"branches inside the limits {inside.ours}, missing {inside.missing}")
assert inside.wrong == 0
assert inside.missing > 0

# %% [markdown]
# Which are missing? `ik_all` has every branch of a pose. In those that the solver misses the wrist is behind axis 1, seen from where
# the shoulder points: it never tries to reach over its back.

# %%
T = robot.fk([10, -110, -60, 20, 60, -30])
every = robot.ik_all(T)
answers = np.array(inverse_mended(T))
for branch in every:
    turned = (answers - branch.axes + 180) % 360 - 180
    known = bool((np.abs(turned).max(axis=1) < 1e-6).any())
    A1, A2, A3 = np.radians(branch.axes[:3])
    ahead = 0.025 + 0.455 * np.cos(A2) + 0.420 * np.cos(A2 + A3) + 0.035 * np.sin(A2 + A3)
    shoulder = "  ".join(f"{axis.name} {value:7.2f}" for axis, value in zip(robot.axes[:3], branch.axes, strict=False))
    print(f"{shoulder}   wrist {1000 * ahead:7.1f} mm ahead: {'found' if known else 'MISSED'}")
    assert known == (ahead > 0)

# %% [markdown]
# `sides=(1, -1)` mends that. Now nothing is wrong, missing, or left without an answer, at random positions, on a grid, and at singular ones.


# %%
def inverse_complete(T):
    return inverse(T, -KINK, sides=(1, -1))


check = chainbuild.crosscheck(robot, inverse_complete, options=options)
print(check)
print("kinds of positions:", ", ".join(sorted(set(check.inverse.samples.kinds))))
assert check.agrees

# %% [markdown]
# ## The answer
#
# The arm that the code has in mind, dashed, and the real one, both at the axis values that the code answers for the cross. A round trip cannot see the difference:
# it stays on the dashed arm on both ways.

# %%
from figures import BLUE, GREY, INK, ORANGE, plot, svg

TARGET = robot.fk([0, -70, 100, 0, -30, 0]).homogeneous
ANSWER = next(a for a in inverse(TARGET) if abs(a[1] + 70) < 30 and abs(a[0]) < 1e-9 and abs(a[3]) < 1e-9)


def skeleton(axes, offset):
    """Corners of the arm in its plane, x and z in mm, with the forearm so far above the elbow."""
    rise, pitch = np.radians(-axes[1]), np.radians(-axes[1] - axes[2])
    along, across = np.array([np.cos(pitch), np.sin(pitch)]), np.array([-np.sin(pitch), np.cos(pitch)])
    hand = pitch - np.radians(axes[4])
    corners = [np.array([0, 0]), np.array([0, 400]), np.array([25, 400])]
    corners.append(corners[-1] + 455 * np.array([np.cos(rise), np.sin(rise)]))
    corners.append(corners[-1] + offset * across)
    corners.append(corners[-1] + 420 * along)
    corners.append(corners[-1] + 80 * np.array([np.cos(hand), np.sin(hand)]))
    return np.array(corners)


real, believed = skeleton(ANSWER, 35), skeleton(ANSWER, -35)
assert np.allclose(real[-1], 1000 * robot.fk(ANSWER).translation[[0, 2]], atol=1e-6)
assert np.allclose(believed[-1], 1000 * TARGET[[0, 2], 3], atol=1e-6)

ax = plot(640, 560)
ax.plot(*believed.T, "--", color=GREY, linewidth=2.5, label="the arm of the code")
ax.plot(*real.T, color=BLUE, linewidth=4, solid_joinstyle="round", label="the arm of the machine data")
ax.plot(*real[[2, 3, 5]].T, "o", color=INK, markersize=8)
ax.plot(*believed[-1], "+", color=ORANGE, markersize=22, markeredgewidth=3)
ax.annotate("", real[-1], believed[-1], arrowprops={"arrowstyle": "<->", "color": ORANGE, "linewidth": 1.5})
ax.annotate("target", believed[-1] - [14, 42], color=ORANGE, ha="right")
ax.annotate("70 mm", (real[-1] + believed[-1]) / 2 + [12, -4], color=ORANGE)
ax.set(xlabel="x in mm", ylabel="z in mm", aspect="equal", xlim=(-150, 800), ylim=(-20, 960))
ax.legend(loc="lower right", frameon=False)
ax.set_title("The same axis values on two arms")
svg(ax)
