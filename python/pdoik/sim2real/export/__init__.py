"""The improved model in the user's formats, URDF and MJCF, as far as these have words for it."""

from .checked import improved_mjcf, improved_urdf
from .export import export_mjcf, export_urdf, write_exports

__all__ = [
    "export_mjcf",
    "export_urdf",
    "improved_mjcf",
    "improved_urdf",
    "write_exports",
]
