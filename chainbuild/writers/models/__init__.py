"""A machine for other programs: URDF, MJCF, SRDF, parameters of ortho-parallel arms.

In reading order: `robotfiles`, `masses`, `notes`, `home`, `loops`, `meshes`, `urdf`, `mjcf`, `srdf`, `opw`, `export`.
"""
