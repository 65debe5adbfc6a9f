"""Formulas for many poses at once, by NumPy or compiled.

In reading order: `operands`, `axes`, `compiled`, `rows`.
"""
