"""What a position, a path or a workspace is like.

`singularity`: measures and words; `collision`: paths, free intervals, parallelograms; `workspace`: maps.
"""
