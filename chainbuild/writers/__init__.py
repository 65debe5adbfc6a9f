"""Files that leave the package: models of a machine, reports, pictures.

In reading order: `models`, `machine_report`, `report`, `report_html`, `svg_plots`, `chart`, `picture`, `pathpicture`.
"""
