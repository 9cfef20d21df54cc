"""Constrained inverse kinematics over distances. Metres, radians and seconds throughout.

>>> import pdoik
>>> robot = pdoik.Robot.builtin("panda")
>>> solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
>>> T_base_tip = robot.fk(robot.mid_configuration())
>>> solver.solve(T_base_tip).success
True
"""

from importlib.metadata import version

import pdoik._import_core  # noqa: F401  # says what to install if a library is missing
from pdoik._core import (
    BatchResult,
    Cloud,
    DhRow,
    Goal,
    LatencyHistogram,
    ObstacleClearance,
    Occupancy,
    Result,
    Robot,
    Scene,
    Shape,
    TrackerResult,
    load_srdf_pairs,
    pairs_always_touching,
    pairs_touching_at,
    simd_name,
    voxel_downsample,
)
from pdoik.descriptions import load_robot, urdf_text
from pdoik.errors import LoadError, OverhangWarning, PdoikError, RobotWarning
from pdoik.lagrangian import Lagrangian
from pdoik.options import (
    AugmentedLagrangianOptions,
    Balance,
    LbfgsOptions,
    LevenbergMarquardtOptions,
    Options,
    Touch,
)
from pdoik.reach_map import Grid, Reachability, reachability
from pdoik.reports import Replay, replay_report, write_report
from pdoik.scenes import load_scene, save_scene
from pdoik.solver import Solver
from pdoik.tracker import Tracker

__version__ = version("pdoik")

__all__ = [
    "AugmentedLagrangianOptions",
    "Balance",
    "BatchResult",
    "Cloud",
    "DhRow",
    "Goal",
    "Grid",
    "Lagrangian",
    "LatencyHistogram",
    "LbfgsOptions",
    "LevenbergMarquardtOptions",
    "LoadError",
    "ObstacleClearance",
    "Occupancy",
    "Options",
    "OverhangWarning",
    "PdoikError",
    "Reachability",
    "Replay",
    "Result",
    "Robot",
    "RobotWarning",
    "Scene",
    "Shape",
    "Solver",
    "Touch",
    "Tracker",
    "TrackerResult",
    "load_robot",
    "load_scene",
    "load_srdf_pairs",
    "pairs_always_touching",
    "pairs_touching_at",
    "reachability",
    "replay_report",
    "save_scene",
    "simd_name",
    "urdf_text",
    "voxel_downsample",
    "write_report",
]
