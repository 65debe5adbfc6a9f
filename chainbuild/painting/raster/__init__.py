"""Bodies as pixels.

In reading order: `surfaces` (meshes), `sight` (which body and face every pixel shows), `pixels` (colours, light and
outlines), `letters`, `lines` (lines and texts), `png` (the file).
"""
