"""Robots as people have them: URDF, xacro, MJCF, or the name of a description that is installed.

Comes in: a file or a name. Goes out: URDF text, or a `Robot` of it, with hulls where asked for.
"""

from .load import load_robot
from .text import urdf_text

__all__ = ["load_robot", "urdf_text"]
