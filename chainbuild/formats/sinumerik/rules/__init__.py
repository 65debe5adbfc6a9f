"""What is refused or doubted, and what a chain needs beyond its links.

In reading order: `plausible`, `axes`, `few_axes`, `arms`, `axis_names`, `chain_data`.
"""
