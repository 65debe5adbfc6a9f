"""Poses that no closed form is sure of, as compiled code: their solutions from those of poses beside, and curves.

In reading order: `steps`, `curves`, `descents`, `beside`, `settle`.
"""
