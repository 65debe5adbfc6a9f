"""From the typed data of a transformation to a recipe of links and joints.

In reading order: `robot_axes`, `tool`, `translate`.
"""
