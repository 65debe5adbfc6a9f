"""What all closed forms use.

In reading order: `subproblems`, `roots`, `serial`, `query`, `axis_values`, `branches`, `free_axis`, `beside`,
`families`.
"""
