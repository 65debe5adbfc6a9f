"""What all closed forms use.

In reading order: `plain`, `subproblems`, `roots`, `serial`, `query`, `axis_values`, `branches`, `free_axis`, `beside`,
`members`, `families`.
"""
