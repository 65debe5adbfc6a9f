"""From a file to a `Machine`, and from a machine to its chain.

In reading order: `load`, `text`, `neighbours`, `overlay`, `overlay_poses`, `overlay_sums`, `overlay_useless`,
`entries`, `machine`, `listing`, `effects`.

The dialects have rooms of their own: `sinumerik`, `twincat`, `urdf`, `dh`.
"""
