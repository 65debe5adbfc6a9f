"""Pictures of machines: bodies placed in the site, seen from a side, as pixels or polygons.

In reading order: `views` (from where one looks), `stage` (which bodies stand where), `colours`, `raster` (pixels),
`vector` (polygons), `marks` (lines and texts), `overlay` (frames, lengths, traces), `picture` (the file).
"""
