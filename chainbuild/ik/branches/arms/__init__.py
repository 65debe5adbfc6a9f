"""Arms solved by subproblems: a position half and an orientation half.

In reading order: `orientation`, `two_joints`, `general_reach`, `positioner`, `loose_turns`, `arms`, `angle_pairs`,
`parallel_axes`, `three_parallel`, `virtual_joints`.
"""
