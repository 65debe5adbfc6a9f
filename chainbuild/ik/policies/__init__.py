"""What is done with an answer: who is asked for it, and which of several is taken.

In reading order: `controller`, `four_axis`, `redundancy`, `status`, `status_path`.
"""
