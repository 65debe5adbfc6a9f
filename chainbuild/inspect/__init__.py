"""Views of a robot: a meshcat scene and a self-contained page."""
