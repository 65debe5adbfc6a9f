"""Cross-check: another solver or a recording beside the model, and what their difference says.

In reading order: `crosscheck`, `samples`, `eaik_model`, `other_solvers`, `comparison`, `offsets`, `diagnosis`,
`evidence`, `convention_trials`, `data_trials`.
"""
