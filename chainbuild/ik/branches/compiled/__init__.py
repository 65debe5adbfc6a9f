"""Closed forms as compiled code (extra `fast`): regular poses in microseconds, the others are left to the plain path.

In reading order: `constants`, `small`, `quartic`, `spherical`, `direct`, `finish`, `entries`, `quick`.
"""
