"""Looking at a robot: a meshcat scene and a self-contained page.

In reading order: `scene`, `labels`, `sweep`, `panel`, `presets`, `playnotes`, `playback`, `chain_data`, `bundle`,
`export`, `inline`.
"""
