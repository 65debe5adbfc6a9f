"""Solvers: damped inverse kinematics and what stands beside it."""
