"""KIN_TYP 210 and transformations of two steps.

In reading order: `coupling_groups`, `coupling`, `two_steps`.
"""
