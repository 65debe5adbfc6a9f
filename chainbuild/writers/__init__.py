"""Files that leave the package: URDF, MJCF, SRDF, reports, pictures.

In reading order: `urdf`, `notes`, `masses`, `mjcf`, `srdf`, `export`, `report`, `report_html`, `svg_plots`, `chart`,
`picture`, `pathpicture`.

The report of a machine has a room of its own: `machine_report`.
"""
