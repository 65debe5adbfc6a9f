"""KIN_TYP 210 and transformations of two steps.

In reading order: `coupling_groups`, `coupling_axes`, `coupling`, `two_steps`.
"""
