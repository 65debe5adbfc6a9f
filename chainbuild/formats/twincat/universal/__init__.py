"""KIN_TYP 91, the universal kinematic, there and back.

In reading order: `universal_data`, `universal`, `directions`, `as_universal`.
"""
