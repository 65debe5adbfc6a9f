"""What vanishes at a singularity, and where along a motion: the bounds that prove that nothing is missed.

In reading order: `functions` (the factors of the Jacobian's determinant as sums of cosines of the joints), `waves`
(their zeros along a block), `lows` (parts below a threshold), `tracing` (such parts by steps that a bound of the rate
proves), `rates` (that of the smallest singular value), `line` (the geometry of a tip on a line), `linetraced` (what is
traced there).
"""
