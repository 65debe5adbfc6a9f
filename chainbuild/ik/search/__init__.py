"""The damped search: plain on Pinocchio, compiled on arrays; single poses, batches, paths."""
