"""Solids where they are: their triangles, and where two of them are nearest to each other.

A `pdoik.Shape` or a placed hull goes in; triangles, distances and nearest points come out. The
pictures (`pdoik.picture`) and the window in the browser (`pdoik.view`) draw them.
"""

from pdoik.solids.binding import Binding, binding, clearances_of, without_numbers
from pdoik.solids.mesh import shape_mesh
from pdoik.solids.nearest import (
    NearestObstacle,
    Part,
    named_part,
    nearest_obstacle,
    nearest_points,
    placed,
    point_part,
)
from pdoik.solids.surfaces import Surface, part_surface, shape_surface

from .pieces import link_pieces

__all__ = [
    "Binding",
    "NearestObstacle",
    "Part",
    "Surface",
    "binding",
    "clearances_of",
    "link_pieces",
    "named_part",
    "nearest_obstacle",
    "nearest_points",
    "part_surface",
    "placed",
    "point_part",
    "shape_mesh",
    "shape_surface",
    "without_numbers",
]
