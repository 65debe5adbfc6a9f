"""From a file to a `Machine`, and from a machine to its chain.

In reading order: `load`, `text`, `overlay`, `overlay_poses`, `entries`, `machine`, `listing`, `effects`,
`urdf_xml`, `urdf_joints`, `urdf`.

The dialects have rooms of their own: `sinumerik`, `twincat`.
"""
