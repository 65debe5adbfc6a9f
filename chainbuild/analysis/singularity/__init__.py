"""Singularities: measures, names, what they cost.

In reading order: `measures`, `jacobians`, `structure`, `factors`, `singularity`, `locks`, `speeds`, `words`, `loops`,
`names`, `nearest`.
"""
