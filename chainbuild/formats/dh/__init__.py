"""Robots from tables of Denavit-Hartenberg parameters.

In reading order: `rows`, `machine`.
"""
