"""Pictures of solutions: the arm, what it holds, what is around, where the tip is and should be."""

from pdoik._extras import asks_for

with asks_for("plot"):
    from pdoik.picture.solution import draw_solution

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
