"""Nonlinear axis maps, closed loops among them, and maps to the drives.

In reading order: `heads`, `drives`, `length`, `losing`, `rows`, `arms`, `struts`, `table_rods`, `table`, `scissors`.
"""
