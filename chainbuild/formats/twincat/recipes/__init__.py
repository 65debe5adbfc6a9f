"""What the types of the catalogue are written in.

In reading order: `recipe`, `parts`, `head_parts`, `arms`.
"""
