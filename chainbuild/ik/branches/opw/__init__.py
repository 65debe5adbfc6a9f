"""All branches of many poses of an ortho-parallel arm with a spherical wrist.

In reading order: `parameters`, `constants`, `formulas`, `compiled`, `batch`.
"""
