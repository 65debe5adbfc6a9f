"""Bodies of a chain for drawings and collision: one rule for coal, URDF and the page.

In reading order: `inertia`, `geometry`, `geometry_table`, `body`, `shapes`, `rods`, `linkage`.
"""
