"""Bodies as polygons: of each what no other covers, the same on every machine.

No sums of products here go through a library of linear algebra, whose last bit differs between processors; what comes
from elsewhere is rounded first.

In reading order: `facets` (bodies as convex polygons), `hiding` (what others cover), `joining` (what is left, joined),
`svg` (the file).
"""
