"""Builds with a rule of their own: closed loops, and the few machines that look like no other.

In reading order: `bed` (what stands on the floor, the part, the tool), `struts` (an arm with its rod), `columns`
(carriages on columns), `delta` (levers under a plate), `platform` (what the rods hold), `scissors` (two slides with
crossing rods), `lathes` (a ram before a column).
"""
