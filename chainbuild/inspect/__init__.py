"""Looking at a robot: a meshcat scene and a self-contained page.

In reading order: `scene`, `labels`, `sweep`, `panel`, `playnotes`, `playback`, `export`, `inline`.
"""
