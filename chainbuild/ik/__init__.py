"""Inverse kinematics. `solve` shows every stage of it, in order.

In reading order: `solve`, `request`, `result`, `options`, `rules`, `region`, `verify`, `plan`.

The damped search is in `search`, closed forms are in `branches`, what is done with an answer is in `policies`.
"""
