"""Analysis: singularities in words, self-collision, limits, workspace."""
