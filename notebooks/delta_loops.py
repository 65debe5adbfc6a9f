# %% [markdown]
# # A delta robot: closed loops in Pinocchio
#
# **Three motors swing three levers; pairs of rods hang from them and carry one plate. Pinocchio knows trees of joints, not rings. How does this
# machine fit in, why does its plate never tilt, and where can it go?**
#
# `delta_kin37` is such a robot on a TwinCAT CNC (KIN_TYP 37). With a running kernel the sliders move it.

# %%
import chainbuild

robot = chainbuild.Robot.load("delta_kin37")
AXES = [10.0, 40.0, -10.0]
chainbuild.show(robot, at=AXES)

# %% [markdown]
# Its lengths, all of them in the machine data:

# %%
from figures import drawing

machine = chainbuild.load("delta_kin37")
drawing(robot, [0, 0, 0], view="right", dimensions=chainbuild.dimensions(machine))

# %% [markdown]
# ## Cut open, a ring is a tree
#
# Three levers, each with a rod that swings and leans, are three branches. The plate is a branch of its own, carried by three shifts that no
# motor drives. Where a rod's end has to meet its pin of the plate stands a *loop*: a ball, three equations.

# %%
model = robot.model
driven = [axis.name for axis in robot.axes]
passive = [name for name in list(model.names)[1:] if name not in driven]
print("driven: ", *driven)
print("passive:", *passive)
for loop in robot.chain.loops:
    print(f"{loop.name}: {loop.kind} between {loop.frame_a} and {loop.frame_b}")
freedoms = model.nv - 3 * len(robot.chain.loops)
print(f"{model.nv} joints − 3 × {len(robot.chain.loops)} equations = {freedoms} freedoms")
assert freedoms == len(driven)

# %% [markdown]
# ## Closed, by the values of all joints
#
# `robot.q(axes)` gives all twelve joint values. Whether the loops close there is for Pinocchio to say, by constraints of its own. (Its order of
# calls matters: Jacobians of the joints first, then `calc`, then read.)

# %%
import numpy as np
import pinocchio as pin

data = model.createData()


def ball(loop):
    ends = [model.frames[model.getFrameId(name)] for name in (loop.frame_a, loop.frame_b)]
    a, b = ends
    return pin.ConstraintModel(
        pin.PointAnchorConstraintModel(model, a.parentJoint, a.placement, b.parentJoint, b.placement)
    )


balls, results = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
for loop in robot.chain.loops:
    balls.append(ball(loop))
    results.append(balls[-1].createData())


def gaps(q):
    """The three gaps as one vector (9,) in metres, and its derivative by the joints (9, 12)."""
    pin.computeJointJacobians(model, data, q)
    for one, result in zip(balls, results, strict=True):
        one.calc(model, data, result)
    error = np.concatenate([result.extract().constraint_position_error for result in results])
    return error, pin.getConstraintsJacobian(model, data, balls, results)


q = robot.q(AXES)
error, J = gaps(q)
print(f"closed: {np.abs(error).max() < 1e-12};  rank of the equations: {np.linalg.matrix_rank(J, tol=1e-9)}")
assert np.abs(error).max() < 1e-12
assert np.linalg.matrix_rank(J, tol=1e-9) == 9

# %% [markdown]
# Would an open loop be seen? Lean one rod of 500 mm by 1°, and its end is off by the chord 2 · 500 · sin 0.5°.

# %%
open_q = q.copy()
open_q[model.getJointId("J1_lean") - 1] += np.radians(1)
gap = 1000 * np.linalg.norm(gaps(open_q)[0][:3])
print(f"gap {gap:.3f} mm")
assert np.isclose(gap, 2 * 500 * np.sin(np.radians(0.5)), atol=1e-9)

# %% [markdown]
# ## Closing it again
#
# Newton's method on Pinocchio's equations, with the levers held: from a wrong guess for all nine passive joints back to the closed state in a few
# steps, each with about twice as many right digits.

# %%
free = [model.getJointId(name) - 1 for name in passive]
guess = q.copy()
guess[free] += 0.1 * np.array([1, -1, 1, -1, 1, 1, -1, 1, -1])  # 100 mm and 6° off
for step in range(10):
    error, J = gaps(guess)
    size = np.abs(error).max()
    print(f"step {step}: largest gap {1000 * size:.0e} mm" if size > 1e-10 else f"step {step}: closed")
    if size <= 1e-10:
        break
    guess[free] -= np.linalg.solve(J[:, free], error)
assert np.allclose(guess, q, atol=1e-9)

# %% [markdown]
# ## By hand: three balls
#
# chainbuild does not iterate. Shift each lever's end inwards by HD4, and the plate's middle is 500 mm from all three points: the common point of
# three balls. There are two; the plate hangs at the lower one.

# %%
HD1, HD4, HD5, HD6, HD7 = 50, 40, 150, 500, 200  # mm
OUTWARDS = np.radians([-90, 30, 150])  # directions of the arms, from above


def three_balls(axes):
    """Tool in mm, from three lever angles in degrees."""
    t = np.radians(axes)
    radius = HD5 - HD4 + HD7 * np.cos(t)
    P = np.column_stack([radius * np.cos(OUTWARDS), radius * np.sin(OUTWARDS), -HD7 * np.sin(t)])
    ex = (P[1] - P[0]) / np.linalg.norm(P[1] - P[0])
    i = ex @ (P[2] - P[0])
    ey = P[2] - P[0] - i * ex
    j = np.linalg.norm(ey)
    ey, d = ey / j, np.linalg.norm(P[1] - P[0])
    x, y = d / 2, (i * i + j * j) / (2 * j) - i / j * d / 2
    z = np.sqrt(HD6**2 - x * x - y * y)
    ez = np.cross(ex, ey)
    return P[0] + x * ex + y * ey - z * np.sign(ez[2]) * ez - [0, 0, HD1]


rng = np.random.default_rng(3)
rows = rng.uniform(-30, 80, size=(300, 3))
hand = np.array([three_balls(row) for row in rows])
poses = robot.fk_batch(rows)
print(f"{len(rows)} positions agree within a nanometre: {np.abs(1000 * poses[:, :3, 3] - hand).max() < 1e-6}")
assert np.abs(1000 * poses[:, :3, 3] - hand).max() < 1e-6

# %% [markdown]
# ## Why the plate does not tilt
#
# The three shifts of the tree *say* that it does not. The reason is the pairs: two parallel rods of equal length, with pins side by side along *s*, permit a turn
# *ω* of the plate only if (*s* × *d*)·*ω* = 0, with *d* along the rods. Three pairs give three equations for *ω*, and as long as the three vectors *s* × *d*
# span space the only answer is *ω* = 0. Their determinant over the whole range of the levers:

# %%
SIDEWAYS = np.column_stack([-np.sin(OUTWARDS), np.cos(OUTWARDS), np.zeros(3)])


def rods(axes, tool):
    """Unit vectors from levers' ends to the plate's pins, and the velocities of the ends in mm/rad, (…, 3, 3)."""
    t = np.radians(axes)[..., None]
    out = np.column_stack([np.cos(OUTWARDS), np.sin(OUTWARDS), np.zeros(3)])
    up = np.array([0, 0, 1])
    ends = out * (HD5 - HD4 + HD7 * np.cos(t)) - up * HD7 * np.sin(t)
    swing = -out * HD7 * np.sin(t) - up * HD7 * np.cos(t)
    return (np.asarray(tool)[..., None, :] + HD1 * up - ends) / HD6, swing


directions, _ = rods(rows, hand)
assert np.allclose(np.linalg.norm(directions, axis=-1), 1, atol=1e-9)  # the rods have their length
spans = np.abs(np.linalg.det(np.cross(SIDEWAYS, directions)))
print(f"smallest determinant: {spans.min():.3f}")
assert spans.min() > 0.1
assert np.abs(poses[:, :3, :3] - np.eye(3)).max() < 1e-12

# %% [markdown]
# ## Backwards: eight ways
#
# From the plate's place each lever is found alone. It may stand outwards or inwards: 2 · 2 · 2 combinations, of which the limits of the levers leave one.

# %%
T = robot.fk(AXES)
ways = robot.ik_all_batch([T], limits=False)[0]
print(ways.round(2))
inside = robot.ik_all(T)
print("inside the limits:", len(inside))
assert len(ways) == 8
assert np.allclose(robot.fk_batch(ways)[:, :3, 3], T.translation, atol=1e-9)  # all of them close there
assert len(inside) == 1
assert np.allclose(inside[0].axes, AXES, atol=1e-6)

# %% [markdown]
# ## How far a degree goes
#
# Rods keep their length: along each rod the plate moves as the lever's end does, *d*·*v* = *d*·*v*(end). Three such equations give the Jacobian. Its largest singular value is how far the
# tool moves at most for one degree of the levers, and with it what an error of a motor costs.


# %%
def jacobian(axes, tool):
    """mm per degree, (…, 3, 3)."""
    d, swing = rods(axes, tool)
    along = (d * swing).sum(axis=-1)
    return np.linalg.solve(d, np.eye(3) * along[..., None, :]) * np.pi / 180


ours = np.array([1000 * robot.jacobian(row)[:3] * np.pi / 180 for row in rows[:50]])
assert np.allclose(jacobian(rows[:50], hand[:50]), ours, atol=1e-9)
print("by hand and by chainbuild the same at 50 positions")

# %% [markdown]
# ## The answer
#
# A section through the workspace, in the plane of the first arm (x = 0): where the tool gets with all levers within −30° … 80°, and how far it moves there for one degree. Its
# edges are circles: where a lever stands at a limit, the tool can only swing about that lever's end. High up in the middle a degree moves the tool by 3 mm at most, at the sides by
# twice that: the same motors place it half as well there.

# %%
from figures import BLUE, GREY, INK, ORANGE, plot, svg


def levers(y, z):
    """Lever angles in degrees at tool positions in the section, (3, …); beyond reach far outside the limits."""
    found = []
    for outwards in OUTWARDS:
        along, across = y * np.sin(outwards) + HD4 - HD5, y * np.cos(outwards)
        down = z + HD1
        share = (along**2 + across**2 + down**2 + HD7**2 - HD6**2) / (2 * HD7 * np.hypot(along, down))
        angle = np.degrees(np.arctan2(-down, along) - np.arccos(np.clip(share, -1, 1)))
        found.append(np.where(np.abs(share) <= 1, angle, 80 + 1000 * (np.abs(share) - 1)))
    return np.array(found)


assert np.allclose(levers(*(1000 * robot.fk([25, 40, 40]).translation[1:])), [25, 40, 40], atol=1e-6)

Y, Z = np.meshgrid(np.linspace(-450, 450, 181), np.linspace(-780, -280, 101))
angles = levers(Y, Z)
margin = np.minimum(angles + 30, 80 - angles).min(axis=0)
reach = np.linalg.svd(jacobian(np.moveaxis(angles, 0, -1), np.stack([0 * Y, Y, Z], axis=-1)), compute_uv=False)[..., 0]
inside = np.where(margin >= 0, reach, np.nan)
middle = np.nanmin(inside)
assert middle < 3
assert abs(Y.flat[np.nanargmin(inside)]) < 20
assert np.nanmax(inside) > 2 * middle
assert abs(Y.flat[np.nanargmax(inside)]) > 150

ax = plot(720, 620)
ax.contourf(Y, Z, margin, levels=[0, 200], colors=[BLUE], alpha=0.14)
ax.contour(Y, Z, margin, levels=[0], colors=[BLUE], linewidths=2)
lines = ax.contour(Y, Z, inside, levels=[3, 3.5, 4, 5, 6], colors=[ORANGE], linewidths=1.2)
ax.clabel(lines, fmt="%g mm/°", fontsize=9)
level = np.radians(25)
arm = np.array([[-HD5, 0], [-HD5 - HD7 * np.cos(level), -HD7 * np.sin(level)]])
tool = 1000 * robot.fk([25, 40, 40]).translation[1:]
plate = np.array([[tool[0] - HD4, tool[1] + HD1], [tool[0] + HD4 / 2, tool[1] + HD1]])
ax.plot([-HD5, HD5 / 2], [0, 0], color=GREY, linewidth=6, solid_capstyle="butt")
ax.plot(*np.vstack([arm, plate[:1]]).T, color=INK, linewidth=3)
ax.plot(*np.vstack([arm, plate[:1]]).T, "o", color=INK, markersize=7)
ax.plot(*plate.T, color=INK, linewidth=4)
ax.plot([tool[0], tool[0]], [tool[1] + HD1, tool[1]], color=INK, linewidth=2)
ax.annotate("motor", (-HD5, 22), ha="center")
ax.annotate("lever, 25°", (-345, -28), ha="right")
ax.annotate("rod", (-262, -250), ha="right")
ax.set(xlabel="y in mm", ylabel="z in mm", aspect="equal", xlim=(-460, 460), ylim=(-790, 60))
ax.set_title("Where the tool gets, and how far one degree of the levers moves it")
svg(ax)
