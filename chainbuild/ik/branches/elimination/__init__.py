"""Six joints without a known structure.

In reading order: `conformal`, `loop`, `eliminant`, `cuts`, `elimination`.
"""
