"""The robot: a chain as a Pinocchio model. The only room that imports pinocchio and coal."""
