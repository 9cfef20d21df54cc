"""Colours of what pictures show."""

from __future__ import annotations

from matplotlib.colors import LinearSegmentedColormap

HULL, BONE, JOINT = "#5b8fc7", "#2b2f36", "#f28e2b"
SHAPE, HELD, SURFACE = "#c9a66b", "#8a63b8", "#8a8f98"
SHAPE_FAILS = "#f0958c"
FAILS, NEAR = "#d3151b", "#2b2f36"
MET, NOT_MET = "#1b7f3b", "#b3261e"  # of words
GAP_COLORS = LinearSegmentedColormap.from_list("gap", ["#d3151b", "#f59a23", "#e6d47f", "#9fb1bf"])
FAR = 0.3  # gaps beyond it look alike [m]
