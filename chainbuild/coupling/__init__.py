"""A motion distributed over partial kinematics (KIN_TYP 210, composed chains).

In reading order: `partial_state`, `distribution`.
"""
