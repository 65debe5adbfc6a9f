"""Self-collision by coal.

In reading order: `solids`, `model`.
"""
