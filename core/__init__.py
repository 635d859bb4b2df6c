"""The physics: deformable elliptical grains, relaxed quasistatically.

Usable alone from a notebook; imports neither a window nor a video library. Symbols, units and
equations: MODEL.md beside this file.
"""
