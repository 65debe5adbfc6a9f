"""The damped search: plain on Pinocchio, compiled on arrays; single poses, batches, paths.

In reading order: `problem`, `solver`, `found`, `plain`, `reason`, `table`, `batch`, `words`, `path`, `lookahead`.

`starts` holds where a search begins, `compiled` the compiled twins of `plain`.
"""
