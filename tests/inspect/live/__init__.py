"""Tests of the page with Python behind it."""
