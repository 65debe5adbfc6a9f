"""All branches of many arms, every solver side by side: `make bench-arms`, `python -m tests.bench.arms`.

`geometry` (an arm in plain NumPy, calibrated ones), `truth` (all branches of a pose, what is missed and wrong), `peers`
(the solvers), `measure` (poses, clock, counts), `__main__` (the run and its file).
"""
