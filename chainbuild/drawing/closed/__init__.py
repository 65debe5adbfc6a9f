"""Closed loops drawn: what a machine on rods consists of.

In reading order: `struts` (an arm with its rod), `columns` (carriages on columns), `delta` (levers under a plate),
`platform` (what the rods hold), `scissors` (two slides with crossing rods).
"""
