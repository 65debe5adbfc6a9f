"""Closed forms as compiled code (extra `fast`): regular poses in microseconds, the others are left to the plain path.

In reading order: `constants`, `small`, `quartic`, `spherical`, `direct`, `angle_pairs`, `three_parallel`, `axes`,
`finish`, `entries`, `quick`.

`general` solves six rotary joints in any arrangement.
"""
