"""Every threshold of the package, named by its reason."""

from __future__ import annotations

from typing import Final

# A pose that a solver returns is verified by forward kinematics against these.
IK_POSITION_M: Final = 1e-6
IK_ROTATION_RAD: Final = 1e-6

# Angles this close to a multiple of 90° are taken as exact: files written on different machines then agree to the
# last digit.
RIGHT_ANGLE_DEG: Final = 1e-12

# Below this cosine of the middle angle the first and third pose angle cannot be told apart (gimbal lock).
GIMBAL_LOCK: Final = 1e-9

# Arithmetic noise of an angle [rad] or of a cosine: smaller differences are ignored.
ANGLE_NOISE: Final = 1e-13

# An axis, or a sum of axes, this little [mm, deg] beyond its limit is taken to be at the limit: controls count in
# 1e-4 mm or degrees, and a micrometre of the pose corresponds to more.
LIMIT_SLACK: Final = 1e-6

# An axis value [deg] counts as below zero for status and turn from here on: -2.5e-15 is a zero that was rounded.
BELOW_ZERO_DEG: Final = 1e-9

# A direction vector shorter than this is taken as zero.
ZERO_VECTOR: Final = 1e-12

# How far a direction may be from unit length before it counts as not normalised.
UNIT_VECTOR: Final = 1e-6

# How far R·Rᵀ may be from 1 in a pose given by the user.
ROTATION_MATRIX: Final = 1e-6

# How far RᵀR of a rotation that was computed in 64 bits may be from 1: what is farther off has lost digits.
EXACT_ROTATION: Final = 1e-12

# How far a quaternion's norm may be from 1 in a table: files carry rounded digits.
QUATERNION_NORM: Final = 1e-3

# Pose angles in a table contradict the quaternion beside them where they differ by more: four decimals of a
# quaternion are 0.01 degrees.
ANGLES_BESIDE_QUATERNION_DEG: Final = 0.05

# Singular values below this share of the largest count as lost freedoms when the task of a chain is chosen.
RANK: Final = 1e-8

# Limits assumed where neither machine data nor overlay give any (SI).
ASSUMED_ROTARY_LIMIT_DEG: Final = 360.0
ASSUMED_LINEAR_LIMIT_MM: Final = 10_000.0

# Larger axis values than this are taken as a mistake: the arithmetic could not keep 1e-6 mm.
HUGE_AXIS_VALUE: Final = 1e9

# Arms whose main lengths differ by more than this factor, or whose reach is outside this range, leave a warning: most
# have a wrong unit. None is refused for it.
ARM_LENGTH_RATIO: Final = 50.0
ARM_REACH_MM: Final = (50.0, 50_000.0)

# Counts of 1e-4 mm or degrees below this (0.1 mm) leave a warning: with a fraction, or where all lengths are below.
SMALL_COUNT: Final = 1000.0

# A pose farther away than this [m] is taken as a mistake.
HUGE_POSITION_M: Final = 1e6

# A mass [kg], or a moment of inertia [kg·m²], larger than this is taken as a mistake: beside it the arithmetic could
# not keep those of the other links.
HUGE_INERTIA: Final = 1e9

# Bounds on what is read, so that a wrong file cannot fill the memory.
MAX_FILE_BYTES: Final = 64 * 2**20
MAX_LINE_CHARACTERS: Final = 100_000

# A solver stops when its squared residual (m² and rad²) is below this: three digits better than what is verified.
IK_RESIDUAL_SQUARED: Final = 1e-18
