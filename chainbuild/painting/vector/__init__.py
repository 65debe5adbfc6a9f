"""Bodies as polygons that cover each other in the right order, the same on every machine.

No sums of products here go through a library of linear algebra, whose last bit differs between processors; what comes
from elsewhere is rounded first.

In reading order: `facets` (bodies as planes and polygons), `tree` (who covers whom), `outline` (borders and lines of
what is painted at once), `svg` (the file).
"""
