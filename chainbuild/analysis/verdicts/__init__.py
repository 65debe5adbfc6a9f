"""Verdicts of a control on positions and paths close to singularities.

In reading order: `controlmeasure` (what it compares with its thresholds), `thresholds` (them, and single positions),
`zones` (parts of blocks at or below one), `sampledzones` (those that are searched), `blockverdicts` (the results),
`judging` (a whole path).
"""
