"""Closed forms: every branch of a pose.

In reading order: `every`, `direct`, `closed`, `multistart`, `status_turn`, `status_filter`.

`core` holds what all of them use, `arms` the arms by subproblems, `elimination` the general six joints, `opw` all
branches of many poses of an ortho-parallel arm.
"""
