"""Inverse kinematics: damped search, closed forms, redundancy resolution."""
