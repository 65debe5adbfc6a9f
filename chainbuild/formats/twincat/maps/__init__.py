"""Nonlinear axis maps, and maps to the drives.

In reading order: `heads`, `drives`, `length`.
"""
