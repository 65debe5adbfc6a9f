"""Files that leave the package: URDF, SRDF, reports, pictures.

In reading order: `urdf`, `notes`, `srdf`, `report`, `report_html`, `svg_plots`, `chart`, `picture`,
`pathpicture`.
"""
