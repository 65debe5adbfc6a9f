"""The kinematic chain: the one thing between machine data and everything computed from them.

In reading order: `elements`, `axismap`, `geometry`, `check`, `poses`, `fold`, `assemble`, `names`, `carried`,
`compose`, `bodies`, `rods`, `geometry_table`.
"""
