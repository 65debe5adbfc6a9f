"""What programs state and controllers show of a pose: columns of a display, vectors, status and turn.

In reading order: `display`, `vectors`, `status`, `named`.
"""
