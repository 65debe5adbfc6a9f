"""Bodies of a chain for drawings and collision: one rule for coal, URDF and the page.

In reading order: `inertia`, `geometry`, `geometry_table`, `placed`, `body`, `shapes`, `rods`, `linkage`.
"""
