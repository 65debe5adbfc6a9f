"""The catalogue of the types and the chain of one of them.

In reading order: `catalogue`, `displays`, `draft`.
"""
