"""Closed forms: every branch of a pose."""
