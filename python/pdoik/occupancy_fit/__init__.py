"""Find the hulls that hold a robot's collision geometry (Sec. coll_avoid), and closer capsules.

>>> fit = fit_occupancy("robot.urdf", packages=["share"])  # doctest: +SKIP
>>> print(fit.report)  # doctest: +SKIP
>>> fit.write("robot.occupancy.yaml")  # doctest: +SKIP
"""

from pdoik._extras import asks_for

with asks_for("files"):
    from .capsules import AIM, Capsule, fit_capsules, fit_link
    from .fit import fit_occupancy
    from .hulls import Sphere, Spheroid
    from .pieces import Piece, fit_pieces
    from .report import FitReport, HullReport, LinkReport
    from .result import OccupancyFit
    from .surfaces import LinkNews

__all__ = [
    "AIM",
    "Capsule",
    "FitReport",
    "HullReport",
    "LinkNews",
    "LinkReport",
    "OccupancyFit",
    "Piece",
    "Sphere",
    "Spheroid",
    "fit_capsules",
    "fit_link",
    "fit_occupancy",
    "fit_pieces",
]
