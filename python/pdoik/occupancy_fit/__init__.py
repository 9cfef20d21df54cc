"""Find the spheres and spheroids that hold a robot's collision geometry (Sec. coll_avoid).

>>> fit = fit_occupancy("robot.urdf", package_dirs=["share"])  # doctest: +SKIP
>>> print(fit.report)  # doctest: +SKIP
>>> fit.write("robot.occupancy.yaml")  # doctest: +SKIP
"""

from .fit import fit_occupancy
from .hulls import Sphere, Spheroid
from .report import FitReport, HullReport, LinkReport
from .result import OccupancyFit

__all__ = [
    "FitReport",
    "HullReport",
    "LinkReport",
    "OccupancyFit",
    "Sphere",
    "Spheroid",
    "fit_occupancy",
]
