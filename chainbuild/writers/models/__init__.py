"""A machine for other programs: URDF, MJCF, SRDF.

In reading order: `notes`, `masses`, `urdf`, `mjcf`, `srdf`, `export`.
"""
