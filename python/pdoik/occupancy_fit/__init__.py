"""Find the hulls that hold a robot's collision geometry (Sec. coll_avoid), and closer capsules.

>>> fit = fit_occupancy("robot.urdf", packages=["share"])  # doctest: +SKIP
>>> print(fit.report)  # doctest: +SKIP
>>> fit.write("robot.occupancy.yaml")  # doctest: +SKIP
"""

from typing import TYPE_CHECKING

from pdoik._extras import asks_for
from pdoik._later import later

with asks_for("files"):
    from .capsules import AIM, Capsule, fit_capsules, fit_link
    from .fit import fit_occupancy
    from .hulls import Sphere, Spheroid
    from .pieces import Piece, fit_pieces
    from .report import FitReport, HullReport, LinkReport
    from .result import OccupancyFit
    from .surfaces import LinkNews

if TYPE_CHECKING:
    from .beyond import Beyond
    from .geometry import LinkGeometry, load_geometry
    from .hulls import (
        MARGIN,
        Shape,
        convex_volume,
        half_sum,
        principal_axes,
        smallest_shape,
        tidy_point,
    )
    from .kept import read_fit
    from .overhang import overhang_of, worst_place
    from .pieces import TOLERANCE
    from .rough import Halves, rough_shapes
    from .segments import Capsules
    from .solid import Solid, spread, subdivide
    from .split import clip, cover_stages, union_volume
    from .twins import motion_between
else:
    __getattr__, __dir__ = later(
        __name__,
        {
            "beyond": "Beyond",
            "geometry": "LinkGeometry load_geometry",
            "hulls": "MARGIN Shape convex_volume half_sum principal_axes smallest_shape tidy_point",
            "kept": "read_fit",
            "overhang": "overhang_of worst_place",
            "pieces": "TOLERANCE",
            "rough": "Halves rough_shapes",
            "segments": "Capsules",
            "solid": "Solid spread subdivide",
            "split": "clip cover_stages union_volume",
            "twins": "motion_between",
        },
        "files",
    )

__all__ = [
    "AIM",
    "MARGIN",
    "TOLERANCE",
    "Beyond",
    "Capsule",
    "Capsules",
    "FitReport",
    "Halves",
    "HullReport",
    "LinkGeometry",
    "LinkNews",
    "LinkReport",
    "OccupancyFit",
    "Piece",
    "Shape",
    "Solid",
    "Sphere",
    "Spheroid",
    "clip",
    "convex_volume",
    "cover_stages",
    "fit_capsules",
    "fit_link",
    "fit_occupancy",
    "fit_pieces",
    "half_sum",
    "load_geometry",
    "motion_between",
    "overhang_of",
    "principal_axes",
    "read_fit",
    "rough_shapes",
    "smallest_shape",
    "spread",
    "subdivide",
    "tidy_point",
    "union_volume",
    "worst_place",
]
