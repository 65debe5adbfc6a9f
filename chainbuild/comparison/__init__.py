"""Cross-check: the model against another solver or a recording, with a diagnosis of differences."""
