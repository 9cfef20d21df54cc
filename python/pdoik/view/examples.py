"""What the page has to play with: robots, shapes, points, a map."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import pdoik

from .humanoid import balance_over_feet
from .model import Model, shipped_model
from .session import Session

FloatArray = npt.NDArray[np.float64]

_CLEARANCE = 0.01  # [m]
_MAX_TIME = 0.02  # [s]
_DOWN = np.diag([1.0, -1.0, -1.0, 1.0])  # a tool's z axis points to the floor


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    """Something to look at.

    Attributes:
        name: In the page's menu.
        try_this: What to do with it, in a sentence.
        make: Gives the robot as it looks, and its session.
        maps: Whether what it reaches is computed at once.
        grip: The shape that has arrows at first.
        view: What the camera looks at and from where, (3,) each [m]; None: as `camera_of` has it.
    """

    name: str
    try_this: str
    make: Callable[[], tuple[Model, Session]]
    maps: bool = False
    grip: str | None = None
    view: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None


def _panda_among_shapes() -> tuple[Model, Session]:
    model, session = _arm("panda", _shapes())
    session.set_target("panda_link8", _down(0.5, 0.0, 0.32))
    return model, session


def _ur10_and_points() -> tuple[Model, Session]:
    model, session = _arm("ur10")
    session.set_cloud(_scan())
    session.set_target(session.robot.tip_links[0], _down(0.7, 0.1, 0.45))
    return model, session


def _iiwa_at_a_wall() -> tuple[Model, Session]:
    slit = [
        _box("wall_left", (0.04, 0.5, 0.9), (0.5, 0.43, 0.45)),
        _box("wall_right", (0.04, 0.5, 0.9), (0.5, -0.43, 0.45)),
        _box("lintel", (0.04, 1.36, 0.12), (0.5, 0.0, 0.96)),
    ]
    model, session = _arm("iiwa14", slit)
    T = np.array([[0.0, 0.0, 1.0, 0.68], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.5], [0, 0, 0, 1]])
    session.set_target(session.robot.tip_links[0], T)
    return model, session


def _h1_standing() -> tuple[Model, Session]:
    robot = pdoik.Robot.builtin("h1", "left_ankle_link", ["right_ankle_link", "left_elbow_link"])
    options = pdoik.Options(max_time=_MAX_TIME, self_collision=True, balance=balance_over_feet())
    return shipped_model(robot), Session(robot, options)


EXAMPLES: Sequence[Example] = (
    Example(
        name="Panda among shapes",
        try_this="Drag the hand, or push the box into the arm; Move obstacle has the others.",
        make=_panda_among_shapes,
        grip="box",
    ),
    Example(
        name="UR10 and a scanned table",
        try_this="Drag the hand down next to the box. Voxel size is how far points are thinned.",
        make=_ur10_and_points,
    ),
    Example(
        name="iiwa 14 through a gap",
        try_this="Drag the hand sideways and back: the arm stays within the gap.",
        make=_iiwa_at_a_wall,
        view=((0.45, -0.15, 0.45), (-1.5, -1.4, 1.4)),  # from behind, or the wall would hide it
    ),
    Example(
        name="H1 on its feet",
        try_this="Pull the elbow: both feet hold, and the centre of mass stays over them.",
        make=_h1_standing,
    ),
    Example(
        name="What a Panda reaches",
        try_this="The map is computed now; the tab Reach has its legend, and where it is cut.",
        make=_panda_among_shapes,
        maps=True,
    ),
)


def _arm(name: str, shapes: Sequence[pdoik.Shape] = ()) -> tuple[Model, Session]:
    robot = pdoik.Robot.builtin(name)
    options = pdoik.Options(max_time=_MAX_TIME, clearance=_CLEARANCE, base_collision=False)
    session = Session(robot, options)
    session.set_shapes(shapes)
    return shipped_model(robot), session


def _shapes() -> list[pdoik.Shape]:
    """A table, and on it one of each kind."""
    top = 0.04  # [m]
    corners = [(x, y, 0.0) for x in (-0.07, 0.07) for y in (-0.07, 0.07)]
    return [
        _box("table", (0.6, 1.0, top), (0.62, 0.0, top / 2)),
        _box("box", (0.12, 0.16, 0.26), (0.62, 0.26, top + 0.13)),
        pdoik.Shape.cylinder("can", 0.06, 0.2, _at((0.62, -0.28, top + 0.1))),
        pdoik.Shape.sphere("ball", (0.44, -0.36, top + 0.07), 0.07),
        pdoik.Shape.convex_mesh("pyramid", [*corners, (0.0, 0.0, 0.16)], _at((0.42, 0.36, top))),
    ]


def _scan() -> FloatArray:
    """Points on a table top and on a box that stands on it, (N, 3) [m]."""
    rng = np.random.default_rng(0)
    table = rng.uniform([0.45, -0.5, 0.0], [1.05, 0.5, 0.0], (6000, 3))
    box = rng.uniform([0.7, -0.32, 0.0], [0.95, -0.08, 0.35], (4000, 3))
    low, high = np.array([0.7, -0.32, 0.0]), np.array([0.95, -0.08, 0.35])
    side = rng.integers(0, 5, len(box))  # a face each: four sides and the top
    for k, (axis, end) in enumerate(((0, low), (0, high), (1, low), (1, high), (2, high))):
        box[side == k, axis] = end[axis]
    return np.concatenate([table, box])


def _box(
    name: str, size: tuple[float, float, float], at: tuple[float, float, float]
) -> pdoik.Shape:
    return pdoik.Shape.box(name, size, _at(at))


def _at(xyz: tuple[float, float, float]) -> FloatArray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T


def _down(x: float, y: float, z: float) -> FloatArray:
    T = _DOWN.copy()
    T[:3, 3] = x, y, z
    return T
