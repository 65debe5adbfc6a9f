"""The kinematic chain: the one thing between machine data and everything computed from them.

In reading order: `elements`, `sums`, `axismap`, `drives`, `check`, `poses`, `fold`, `followers`, `assemble`, `names`,
`compose`, `closing`, and the rooms `programmed` and `bodies`.
"""
