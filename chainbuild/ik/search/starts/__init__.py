"""Where a search begins.

In reading order: `sampled`, `arm_reach`, `turned`.
"""
