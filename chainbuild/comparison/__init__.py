"""Cross-check: another solver or a recording beside the model, and what their difference says."""
