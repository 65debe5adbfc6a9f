"""Self-collision along paths, and the limits that follow from it.

In reading order: `pairs`, `pieces`, `paths`, `sweep`, `parallelogram`, `free_ik`.
"""
