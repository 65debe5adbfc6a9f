# %% [markdown]
# # From ROBX data to a URDF that you can trust
#
# **A robot runs on a SINUMERIK. Its only description is the machine data of the ROBX transformation, and a simulation
# wants a URDF. Which number of the file is which length of the arm, and does the URDF put the flange where the
# controller puts it?**
#
# The file is that of a KUKA KR 6 R900, shipped with chainbuild. A path of your own works the same.

# %%
import chainbuild

machine = chainbuild.load("kr6r900")
robot = chainbuild.Robot(machine.chain())
print(machine.title)
for finding in machine.findings:
    print(f"line {finding.span.line}: {finding.code} {finding.severity}: {finding.text}")
print("axes:", ", ".join(f"{axis.name} {axis.lower:g} … {axis.upper:g} {axis.unit}" for axis in robot.axes))

# %% [markdown]
# ## Which number is which length
#
# Machine data name no links. chainbuild finds out by trying: it builds the arm again with one datum 1 mm longer, and looks
# which joint moves.

# %%
lengths = chainbuild.dimensions(machine)
for length in lengths:
    print(f"{length.label:28} places {length.places}")

# %% [markdown]
# The same in the drawing. The arm stands with its upper arm upright and its forearm level, at A2 = −90° and A3 = 90°.

# %%
from figures import drawing

L_SHAPE = [0, -90, 90, 0, 0, 0]
drawing(robot, L_SHAPE, view="front", dimensions=lengths)

# %% [markdown]
# ## The flange, by adding lengths
#
# In this position every length lies along X or Z of the base, so that no sine is needed. Read off the drawing, from the
# floor to the flange:
#
# * **forward:** the shoulder's 25, the forearm's 420, the flange's 80
# * **up:** the column's 400, the upper arm's 455, and the forearm lies 35 above the elbow

# %%
import numpy as np

flange = 1000 * robot.fk(L_SHAPE).translation
print("chainbuild [mm]:", flange.round(6) + 0.0)
assert np.allclose(flange, [25 + 420 + 80, 0, 400 + 455 + 35], atol=1e-9)

# %% [markdown]
# ## The URDF
#
# `write_urdf` writes `NAME/NAME.urdf`. Joints have the names of the axes, limits and speeds come along, and where an axis
# alone drives a joint, the joint value *is* the axis value, in radians.

# %%
import tempfile

folder = tempfile.TemporaryDirectory()
path = chainbuild.write_urdf(robot, folder.name)
text = path.read_text()
start = text.index('<joint name="A1"')
print(text[start : text.index("</joint>", start)] + "</joint>")

# %% [markdown]
# ## A reader of twenty lines
#
# To trust the file, read it without chainbuild and without Pinocchio: a URDF joint is a shift, three fixed angles and
# a turn about an axis. Nothing below knows anything of ROBX.

# %%
import xml.etree.ElementTree as ET


def turn(axis, angle):
    """Rotation about a unit vector (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def floats(element, name):
    return np.array(element.get(name).split(), dtype=float)


def tool_of_urdf(root, angles):
    """The frame `tool` in the first link, from the file's text alone."""
    above = {joint.find("child").get("link"): joint for joint in root.iter("joint") if joint.find("child") is not None}
    link, T = "tool", np.eye(4)
    while link in above:
        joint, step = above[link], np.eye(4)
        roll, pitch, yaw = floats(joint.find("origin"), "rpy")
        step[:3, :3] = turn([0, 0, 1], yaw) @ turn([0, 1, 0], pitch) @ turn([1, 0, 0], roll)
        step[:3, 3] = floats(joint.find("origin"), "xyz")
        if joint.get("type") == "revolute":
            step[:3, :3] = step[:3, :3] @ turn(floats(joint.find("axis"), "xyz"), angles[joint.get("name")])
        link, T = joint.find("parent").get("link"), step @ T
    return T


root = ET.fromstring(text)
names = [axis.name for axis in robot.axes]
print((1000 * tool_of_urdf(root, dict(zip(names, np.radians(L_SHAPE), strict=True)))[:3, 3]).round(6) + 0.0)

# %% [markdown]
# ## Everywhere, not only in one position
#
# Two hundred positions drawn over the whole limits, by this reader and by the one of Pinocchio (urdfdom). The worst
# difference is rounding.

# %%
import pinocchio as pin

limits = np.array([[axis.lower, axis.upper] for axis in robot.axes])
rows = np.random.default_rng(1).uniform(*limits.T, size=(200, 6))
ours = robot.fk_batch(rows)

plain = np.array([tool_of_urdf(root, dict(zip(names, row, strict=True))) for row in np.radians(rows)])

model = pin.buildModelFromUrdf(str(path))
data, tool = model.createData(), model.getFrameId("tool")
order = [names.index(name) for name in list(model.names)[1:]]  # by name: readers sort joints as they like
urdfdom = []
for row in np.radians(rows):
    pin.framesForwardKinematics(model, data, row[order])
    urdfdom.append(data.oMf[tool].homogeneous.copy())

for who, poses in (("twenty lines", plain), ("urdfdom", np.array(urdfdom))):
    apart = np.abs(poses - ours).max()
    print(f"{who}: agrees within 1e-12 m: {apart < 1e-12}")
    assert apart < 1e-12
folder.cleanup()

# %% [markdown]
# ## Would a wrong sign be seen?
#
# A check that cannot fail proves nothing. `TX3P3_POS[2]`, the 35 mm by which the forearm lies above the elbow, is easily entered with the
# wrong sign: the arm looks nearly the same. Changed in a copy of the machine:

# %%
sideways = next(length.datum for length in lengths if "TX3P3_POS[2]" in length.label)
wrong = chainbuild.Robot(machine.with_values({sideways: -sideways.value}).chain())

apart = 1000 * np.linalg.norm(wrong.fk_batch(rows)[:, :3, 3] - ours[:, :3, 3], axis=1)
print(f"the flange is {apart.min():.3f} … {apart.max():.3f} mm off")
assert np.allclose(apart, 70.0, atol=1e-9)  # 2 × 35 mm, across the forearm, in every position

# %% [markdown]
# ## The answer
#
# The six lengths of the file, and the frames that they lead to. The URDF puts `flange` and `tool` there in every position,
# and by the sums above they stand where the machine data say.

# %%
drawing(robot, [0, -60, 100, 0, -40, 0], frames=True, dimensions=lengths)
