"""Written files: URDF, SRDF, pictures, cross-check reports."""
