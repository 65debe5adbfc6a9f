"""Analysis: singularities, self-collision, limits, workspace."""
