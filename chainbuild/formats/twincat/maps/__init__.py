"""Nonlinear axis maps.

In reading order: `heads`, `length`.
"""
