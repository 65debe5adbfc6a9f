# %% [markdown]
# # First light: from a machine file to a moving robot
#
# A CNC that moves a robot has the robot's kinematics in its machine data. chainbuild reads these data and builds a Pinocchio model.
#
# This notebook shows the main steps for the KUKA KR 6 R900 that is shipped with the package (a SINUMERIK with the ROBX transformation). Enter the path of your own file in the first cell to see your machine.

# %%
import chainbuild

machine = chainbuild.load("kr6r900")  # a path, or the name of a shipped machine
print(machine.title, "-", machine.dialect)
for entry in machine.kinematics():
    print(f"kinematic {entry.id}: {entry.type}, {entry.title}")

# %% [markdown]
# ## Contents of the file, and findings
#
# Reading never changes data silently. Doubtful data become numbered findings; points that the manuals leave open become named conventions, which you can change with `machine.chain(conventions={...})`.

# %%
chain = machine.chain()

for finding in dict.fromkeys((*machine.findings, *chain.findings)):
    print(finding.code, finding.severity, "-", finding.text)
for used in chain.conventions:
    print(f"convention {used.convention.name} = {used.choice}: {used.convention.question}")

for axis in chain.axes:
    note = " (assumed: the file gives no limits)" if axis.assumed else ""
    print(f"{axis.name}: {axis.lower:g} ... {axis.upper:g} {axis.unit}{note}")

# %% [markdown]
# ## Forward kinematics
#
# Axis values are what the controller shows: millimetres and degrees, in its order. The pose is a `pin.SE3` in metres: the tool in the workpiece frame.

# %%
import numpy as np

robot = chainbuild.Robot(chain)
axes = [10, -80, 95, 20, 60, -30]
T = robot.fk(axes)
print("position [mm]:", (1000 * T.translation).round(3))
print("rotation:", T.rotation.round(6), sep="\n")

# %% [markdown]
# ## Inverse kinematics
#
# The solver keeps the axis limits and verifies its answer by forward kinematics before the status is `ok`. A pose has several solutions; the solver stays near `start`.

# %%
result = robot.ik(T, start=[0, -90, 90, 0, 45, 0])
print(result.status, result.axes.round(6))
print("within 1 nm and a millionth of a degree:", result.position_error < 1e-9 and result.rotation_error < 1e-8)

assert result.success
assert np.allclose(robot.fk(result.axes).homogeneous, T.homogeneous, atol=1e-6)

# %% [markdown]
# ## The Pinocchio model
#
# `robot.model` is an ordinary Pinocchio model; joint values are SI. `robot.q` and `robot.axes_from_q` convert between the controller's values and Pinocchio's: by name they are the same numbers, in metres and radians, unless axes are coupled, as in a parallelogram, or the axis map is nonlinear.

# %%
import pinocchio as pin

q = robot.q(axes)
for name, angle in zip(list(robot.model.names)[1:], q, strict=True):
    print(f"{name}: {angle:+.6f} rad")

data = robot.model.createData()
pin.framesForwardKinematics(robot.model, data, q)
print("flange in the base [m]:", data.oMf[robot.model.getFrameId("flange")].translation.round(6))
assert np.allclose(robot.axes_from_q(q), axes)

# %% [markdown]
# ## URDF
#
# One file for every URDF reader. Its header lists what the format cannot express.

# %%
import tempfile
from pathlib import Path

folder = Path(tempfile.mkdtemp())
path = chainbuild.write_urdf(robot, folder)
print(path.relative_to(folder))

reread = pin.buildModelFromUrdf(str(path))
print("joints read back:", list(reread.names)[1:])

# %% [markdown]
# ## See it move
#
# The page of the machine, for anyone who has to confirm that this is it. Sliders, the displayed pose and the arrows at the tool move it; limits, singular positions and every other solution are shown. The bodies are drawn, not measured.
#
# The page and Python keep the same axis values: after a drag, `view.axes` is where the machine stands. As one HTML file without server or network: `chainbuild inspect kr6r900 --export page.html`.

# %%
view = chainbuild.show(robot, at=axes)  # needs the extra: pip install 'chainbuild[notebook]'
view

# %%
view.axes = [0, -90, 90, 0, 45, 0]  # moves the page
print(view)
