"""TwinCAT CNC: parameter lists and the kinematics that they configure."""
