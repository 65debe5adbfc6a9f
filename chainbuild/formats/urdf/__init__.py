"""Robots from URDF files.

In reading order: `xml`, `joints`, `tree`, `bodies`, `robot`, `data`, `machine`.
"""
