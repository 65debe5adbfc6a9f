"""What is drawn over a machine: frames, lengths, the trace of the tool, and their names.

In reading order: `placing` (labels that do not cover each other), `triads`, `trace`, `measures` (which length of the
file places what), `dimensions` (as lines).
"""
