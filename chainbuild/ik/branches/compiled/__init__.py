"""Closed forms of one pose as compiled code.

In reading order: `angle_pairs`, `three_parallel`.
"""
