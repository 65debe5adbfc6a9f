"""Drawn machines: the laws that bodies of every machine keep, and what the rules draw."""
