"""Files that leave the package: models of a machine, reports, pictures.

In reading order: `models`, `report`, `report_html`, `svg_plots`, `chart`, `picture`, `pathpicture`.
"""
