"""The page with Python behind it: machine data that are changed, collisions, sections, several tabs in step.

In reading order: `datalist`, `contacts`, `sections`, `session`, `messages`, `answers`, `tokens`, `worker`, `hub`,
`handlers`, `server`.
"""
