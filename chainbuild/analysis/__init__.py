"""What a position, a path or a workspace is like.

`singularity`: measures and words; `vanishing`: where along a motion they are small; `path`: whole paths, between their
rows, too; `verdicts`: what a control makes of them; `collision`: contacts, free intervals, parallelograms;
`workspace`: maps.
"""
