"""Six rotary joints in any arrangement as compiled code: sixteen eigenvalues, each real one a solution.

In reading order: `constants`, `eigen`, `equations`, `solutions`, `solve`.
"""
