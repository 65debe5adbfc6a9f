"""The compiled twins of the plain search (extra `fast`).

In reading order: `packing`, `inner`, `kernels`, `least_squares`, `limits`, `starts`, `search`, `entries`, `slides`,
`cores`.
"""
