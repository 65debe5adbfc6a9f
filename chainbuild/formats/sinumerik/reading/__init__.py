"""From text to the typed data of a transformation.

In reading order: `catalogue`, `values`, `assignment`, `reader`, `sections`, `misspelt`, `data_table`, `robx`,
`transformations`, `alarms`.
"""
