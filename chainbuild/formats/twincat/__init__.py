"""TwinCAT CNC: parameter lists and the kinematics that they configure.

In reading order: `files`, `machine`, `translate`, `axis_offsets`, `parameters`, `geometry`.

They stand on `lists` (from text to typed configuration), `maps` (nonlinear axis maps), `recipes` (what a type is
written in), `families` (the types), `types` (their catalogue), `universal` (91) and `coupling` (210, two steps).
"""
