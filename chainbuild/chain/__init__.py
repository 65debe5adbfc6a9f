"""The kinematic chain: the one thing between machine data and everything computed from them.

In reading order: `elements`, `display`, `sums`, `axismap`, `drives`, `geometry`, `check`, `poses`, `fold`, `assemble`,
`names`, `compose`, and the room `bodies`.
"""
