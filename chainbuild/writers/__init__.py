"""Files that leave the package: URDF, and how files are written at all."""
