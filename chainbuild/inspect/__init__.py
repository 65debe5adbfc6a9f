"""Looking at a robot: a meshcat scene and a self-contained page.

In reading order: `scene`, `labels`, `sweep`, `panel`, `presets`, `chain_data`, `playnotes`, `playback`, `bundle`,
`export`, `notebook`; the page with Python behind it: `live`.
"""
