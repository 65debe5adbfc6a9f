"""Paths: what happens between the rows of a table, too.

In reading order: `motion` (between two rows), `linesolve` (axes along a line), `nearby` (which parts are close to a
singularity), `places` (the results), `collect` (parts put together), `limitwatch` and `feeds` (limits and speeds),
`along` (a whole path), `dips` (for pictures).
"""
