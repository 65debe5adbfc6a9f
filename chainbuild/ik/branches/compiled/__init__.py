"""Closed forms as compiled code (extra `fast`): regular poses in microseconds, the others are left to the plain path.

In reading order: `constants`, `small`, `angle_pairs`, `spherical`, `direct`, `three_parallel`, `axes`, `finish`,
`status`, `entries`, `forms`, `quick`.

`general` solves six rotary joints in any arrangement, `doubtful` poses that no form is sure of.
"""
