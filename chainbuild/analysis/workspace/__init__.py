"""Maps of the workspace.

In reading order: `mapspec`, `fingerprint`, `maps`.
"""
