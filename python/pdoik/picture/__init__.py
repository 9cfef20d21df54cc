"""Pictures of solutions: the arm, what it holds, what is around, where the tip is and should be."""

from typing import TYPE_CHECKING

from pdoik._extras import asks_for
from pdoik._later import later

with asks_for("plot"):
    from .solution import draw_solution

if TYPE_CHECKING:
    from .contents import contents_of
    from .cube import Cube, in_pieces, shape_triangles
    from .facets import FacetSoup, spheroid_axes
    from .marks import mark_of
    from .overhangs import draw_overhangs
    from .path import draw_path
    from .places import place_map
    from .raster import DepthBuffer, blended
    from .stage import Stage
    from .view import best_azimuth
else:
    __getattr__, __dir__ = later(
        __name__,
        {
            "contents": "contents_of",
            "cube": "Cube in_pieces shape_triangles",
            "facets": "FacetSoup spheroid_axes",
            "marks": "mark_of",
            "overhangs": "draw_overhangs",
            "path": "draw_path",
            "places": "place_map",
            "raster": "DepthBuffer blended",
            "stage": "Stage",
            "view": "best_azimuth",
        },
        "plot",
    )

__all__ = [
    "Cube",
    "DepthBuffer",
    "FacetSoup",
    "Stage",
    "best_azimuth",
    "blended",
    "contents_of",
    "draw_overhangs",
    "draw_path",
    "draw_solution",
    "in_pieces",
    "mark_of",
    "place_map",
    "shape_triangles",
    "spheroid_axes",
]
