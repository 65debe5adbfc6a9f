"""The report of a machine, for whoever must trust a transformation before switching it on.

In reading order: `report`, `given`, `views`, `axes`, `serial`, `dh`, `rows`, `reach`, `singular`, `choices`,
`checkposes`, `checkform`; what it is made of and its two forms: `document`.
"""
