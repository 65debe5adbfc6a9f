"""Closed forms: every branch of a pose.

In reading order: `every`, `many`, `redundant`, `direct`, `closed`, `multistart`, `status_turn`, `status_filter`.

`core` holds what all of them use, `arms` the arms by subproblems, `elimination` the general six joints, `compiled` the
quick path of regular poses, `vectors` formulas for many poses at once, `opw` and `planar` those of ortho-parallel arms
and of arms with three parallel axes.
"""
