"""Pictures of machines: bodies on a stage, seen from a side, as pixels.

In reading order: `views` (from where one looks), `stage` (which bodies stand where), `raster` (which body and face
every pixel shows), `pixels` (colours, light and outlines), `png` (the file).
"""
