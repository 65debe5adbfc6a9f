"""Inverse kinematics. `solve` shows every stage of it, in order.

In reading order: `solve`, `request`, `result`, `rules`, `region`, `verify`, `plan`, `rtcp`, `displayed`, `showing`,
`warm`.

The damped search is in `search`, closed forms are in `branches`, what is done with an answer is in `policies`.
"""
