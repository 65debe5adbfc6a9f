"""A chain in Pinocchio: poses, Jacobians, limits. With `collision` the only room that imports pinocchio and coal.

In reading order: `evaluation`, `product`, `limits`, `ranges`, `inputs`, `mechanism`, `screws`, `closure`, `newton`,
`task_error`, `displayed`; any model of Pinocchio as URDF: `model_urdf`.
"""
