"""Machine tools: the head, what carries the workpiece, and what carries the head.

In reading order: `heads`, `tables`, `stands`.
"""
