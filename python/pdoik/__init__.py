"""Constrained inverse kinematics over distances. Metres, radians and seconds throughout.

>>> import pdoik
>>> robot = pdoik.Robot.builtin("panda")
>>> solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
>>> T_base_tip = robot.fk(robot.mid_configuration())
>>> solver.solve(T_base_tip).success
True
"""

from typing import TYPE_CHECKING, Any

import pdoik._import_core  # says what to install if a library is missing
import pdoik._loaders  # noqa: F401  # puts Robot.from_urdf and its like on Robot
from pdoik._core import (
    Attachment,
    BatchResult,
    Cloud,
    ContactRule,
    Derivatives,
    DhRow,
    Goal,
    LatencyHistogram,
    MotionResult,
    ObstacleClearance,
    Occupancy,
    PathEnd,
    PathResult,
    Result,
    Robot,
    Scene,
    Shape,
    Solutions,
    TrackerResult,
    load_srdf_contacts,
    load_srdf_pairs,
    pairs_always_touching,
    pairs_touching_at,
    simd_name,
    voxel_downsample,
)
from pdoik.errors import (
    GoalWarning,
    LoadError,
    ObstacleWarning,
    OverhangWarning,
    PdoikError,
    RobotWarning,
)
from pdoik.lagrangian import Lagrangian
from pdoik.options import (
    AugmentedLagrangianOptions,
    Balance,
    LbfgsOptions,
    LevenbergMarquardtOptions,
    Options,
    Touch,
)
from pdoik.solver import Solver
from pdoik.tracker import Tracker

__all__ = [
    "Attachment",
    "AugmentedLagrangianOptions",
    "Balance",
    "BasePlace",
    "BasePlaces",
    "BatchResult",
    "Cloud",
    "ContactRule",
    "Derivatives",
    "DhRow",
    "Goal",
    "GoalWarning",
    "Grid",
    "Lagrangian",
    "LatencyHistogram",
    "LbfgsOptions",
    "LevenbergMarquardtOptions",
    "LoadError",
    "MotionResult",
    "ObstacleClearance",
    "ObstacleWarning",
    "Occupancy",
    "Options",
    "OverhangWarning",
    "PathEnd",
    "PathFollower",
    "PathResult",
    "PdoikError",
    "Reachability",
    "Replay",
    "Result",
    "Robot",
    "RobotWarning",
    "Scene",
    "Shape",
    "Solutions",
    "Solver",
    "Touch",
    "Tracker",
    "TrackerResult",
    "Trajectory",
    "load_robot",
    "load_scene",
    "load_srdf_contacts",
    "load_srdf_pairs",
    "pairs_always_touching",
    "pairs_touching_at",
    "place_base",
    "reachability",
    "replay_report",
    "sample_path",
    "save_scene",
    "simd_name",
    "solve_path",
    "time_motion",
    "time_path",
    "urdf_text",
    "voxel_downsample",
    "write_report",
]

if TYPE_CHECKING:
    from pdoik.base_search import BasePlace, BasePlaces, place_base
    from pdoik.descriptions import load_robot, urdf_text
    from pdoik.follow import PathFollower
    from pdoik.paths import sample_path, solve_path
    from pdoik.reach_map import Grid, Reachability, reachability
    from pdoik.reports import Replay, replay_report, write_report
    from pdoik.scenes import load_scene, save_scene
    from pdoik.timing import Trajectory, time_motion, time_path

    __version__: str
else:
    _LATER = {  # imported when asked for, so that a program that solves starts sooner
        "BasePlace": "base_search",
        "BasePlaces": "base_search",
        "Grid": "reach_map",
        "PathFollower": "follow",
        "Reachability": "reach_map",
        "Replay": "reports",
        "Trajectory": "timing",
        "load_robot": "descriptions",
        "load_scene": "scenes",
        "place_base": "base_search",
        "reachability": "reach_map",
        "replay_report": "reports",
        "sample_path": "paths",
        "save_scene": "scenes",
        "solve_path": "paths",
        "time_motion": "timing",
        "time_path": "timing",
        "urdf_text": "descriptions",
        "write_report": "reports",
    }
    _MODULES = {"clouds", "recordings", *_LATER.values()}

    def __getattr__(name: str) -> Any:
        from importlib import import_module, metadata

        if name == "__version__":
            value = metadata.version("pdoik")
        elif name in _MODULES:
            value = import_module(f"pdoik.{name}")
        elif name in _LATER:
            value = getattr(import_module(f"pdoik.{_LATER[name]}"), name)
        else:
            raise AttributeError(f"module 'pdoik' has no attribute {name!r}")
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *_LATER, *_MODULES, "__version__"})
