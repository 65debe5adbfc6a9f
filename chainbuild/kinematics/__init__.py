"""A chain in Pinocchio: poses, Jacobians, limits. With `collision` the only room that imports pinocchio and coal.

In reading order: `evaluation`, `product`, `limits`, `ranges`, `inputs`, `mechanism`, `screws`, `newton`, `task_error`,
`displayed`.
"""
