"""The compiled twins of the plain search (extra `fast`).

In reading order: `packing`, `inner`, `kernels`, `limits`, `starts`, `search`, `entries`, `slides`, `cores`.
"""
