"""A report as data, and its two forms: Markdown, and one HTML page.

In reading order: `blocks`, `numbers`, `markdown`, `style`, `page`.
"""
