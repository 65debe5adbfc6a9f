"""Pictures of machines: bodies placed in the site, seen from a side, as pixels.

In reading order: `views` (from where one looks), `stage` (which bodies stand where), `colours`; `raster` paints pixels.
"""
