"""All branches of many poses of an arm of six rotary axes of which three neighbouring ones are parallel.

In reading order: `formulas`, `constants`, `compiled`, `batch`.
"""
