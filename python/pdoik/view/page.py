"""What the tabs of the panel may ask of the page they are on."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
import viser

from .drawing.limit_scene import LimitScene
from .drawing.nearest_scene import NearestScene
from .drawing.obstacle_scene import ObstacleScene
from .drawing.scene import RobotScene
from .drawing.shape_scene import ShapeScene
from .examples import Example
from .goals import GoalKind
from .model import Model
from .session import Session
from .worker import Worker

FloatArray = npt.NDArray[np.float64]


class Page(Protocol):
    """The page that `viewer.Viewer` is."""

    server: viser.ViserServer
    session: Session
    model: Model
    worker: Worker
    robot_scene: RobotScene
    obstacle_scene: ObstacleScene
    shape_scene: ShapeScene
    nearest_scene: NearestScene
    limit_scene: LimitScene
    read_path: Callable[[Path], Any] | None

    def change_options(self, **changes: Any) -> None:
        """Other options of the solver."""

    def change_goal(self, tip: str, kind: GoalKind) -> None:
        """Another kind of goal for a tip."""

    def change_cone(self, tip: str, cone: float) -> None:
        """How far a tip's axis may point off [rad]."""

    def type_target(self, tip: str, T_base_tip: FloatArray, which: int = 0) -> None:
        """Another pose for one of a tip's targets, (4, 4)."""

    def add_target(self, tip: str) -> None:
        """One more target for a tip, next to the last."""

    def drop_target(self, tip: str) -> None:
        """One target less for a tip."""

    def show_solution(self, q: FloatArray) -> None:
        """A posture that meets the targets, (n,)."""

    def show_ball(self, on: bool, radius: float) -> None:
        """Put the ball where its gizmo is, or take it away [m]."""

    def grip(self, name: str | None) -> None:
        """Give the shape of that name a gizmo, and no other one."""

    def move_cloud(self, on: bool) -> None:
        """Give the cloud its gizmo, or take that away."""

    def take_example(self, example: Example) -> None:
        """Something to play with instead of what is there."""

    def take_builtin(self, name: str) -> None:
        """One of pdoik's own robots."""

    def take_urdf(self, file: viser.UploadedFile) -> None:
        """The robot of a URDF."""

    def take_tip(self, tip_link: str | None) -> None:
        """One tip, or every leaf for None."""

    def take_hulls(self, file: viser.UploadedFile) -> None:
        """Hulls from a file."""

    def fit_hulls(self) -> None:
        """Hulls around the collision geometry."""

    def take_cloud(self, file: viser.UploadedFile) -> None:
        """A cloud from a file."""

    def drop_cloud(self) -> None:
        """No cloud."""

    def take_scene(self, file: viser.UploadedFile) -> None:
        """Shapes, and perhaps a cloud, from a file."""

    def drop_shapes(self) -> None:
        """No shapes."""

    def take_log(self, file: viser.UploadedFile) -> None:
        """A log to replay."""

    def take_path(self, file: viser.UploadedFile) -> None:
        """A path to follow."""

    def follow_again(self) -> None:
        """The path once more, among the obstacles as they are now."""

    def take_map(self, file: viser.UploadedFile) -> None:
        """A reachability map to show."""

    def complaints(self) -> AbstractContextManager[None]:
        """Say on the page what was wrong in the block, and leave things as they were."""
