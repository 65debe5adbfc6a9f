"""Hand-derived forward kinematics, written from the manuals alone and independent of the package under test."""
