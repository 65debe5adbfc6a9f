"""SINUMERIK machine data of the ROBX transformation.

In reading order: `machine`, `parameters`.

They stand on `reading` (from text to typed data), `geometry` (from typed data to a recipe) and `rules` (what is
refused or doubted, and what a chain needs beyond its links).
"""
