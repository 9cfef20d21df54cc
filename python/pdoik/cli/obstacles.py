"""The obstacles of a solve: a cloud, what is kept of it, and a scene's shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik._addresses import at_home
from pdoik.clouds import load_cloud
from pdoik.scenes import SceneFile, read_scene_file

from .messages import fail, misuse_fails, tell, warn, warnings_given

FloatArray = npt.NDArray[np.float64]

_FARTHEST_LIKELY = 100.0  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstacles:
    """Points as their files have them, and as the solver gets them; and shapes.

    Attributes:
        file: Of the cloud, or of the scene without one.
        leaf: Of the cloud, or of the scene without one [m]; 0 for every point.
        surface: Points of the cloud and of the scene, (N, 3) [m].
        cloud: What is kept of them, (K, 3), or (K, 4) with a radius each [m].
        scene: Where the shapes are from; None for none.
    """

    file: Path
    leaf: float
    surface: FloatArray
    cloud: FloatArray
    scene: SceneFile | None = None

    @property
    def shapes(self) -> tuple[pdoik.Shape, ...]:
        return () if self.scene is None else self.scene.shapes

    @property
    def attached(self) -> tuple[pdoik.Attachment, ...]:
        """What links carry."""
        return () if self.scene is None else self.scene.attached

    def kept(self) -> pdoik.Scene:
        """What the solver gets."""
        return self._with(self.cloud)

    def whole(self) -> pdoik.Scene:
        """The same before points were thinned out."""
        return self._with(self.surface)

    def _with(self, points: FloatArray) -> pdoik.Scene:
        contacts = () if self.scene is None else self.scene.contacts
        return pdoik.Scene(self.shapes, cloud=points if len(points) else None, contacts=contacts)


def solver_of(
    robot: pdoik.Robot, options: pdoik.Options, obstacles: Obstacles | None
) -> pdoik.Solver:
    """A solver with what is attached to links in the scene.

    Raises:
        ValueError: It cannot be made, or they cannot carry that.
    """
    solver = pdoik.Solver(robot, options)
    if obstacles is not None:
        solver.attach_all(obstacles.attached)
    return solver


def refuse_attached(obstacles: Obstacles | None) -> None:
    """Leave with status 2 where links carry something in the scene, which this leaves out."""
    if obstacles is not None and obstacles.scene is not None and obstacles.attached:
        names = ", ".join(shape.name for each in obstacles.attached for shape in each.shapes)
        path = obstacles.scene.path
        fail(f"--scene {path}: links carry {names} in it, which only solve and path know")


def check_hulls(robot: pdoik.Robot, cloud: Path | None, scene: Path | None) -> None:
    """Leave with status 2 where there are obstacles, and the robot has nothing to keep off them."""
    if len(robot.occupancy):
        return
    for option in ["--cloud"] * (cloud is not None) + ["--scene"] * (scene is not None):
        fail(
            f"{option}: {robot.name} has no hulls to keep clear; give --occupancy FILE.yaml"
            " (pdoik occupancy ROBOT --out FILE.yaml makes one)"
        )


def load_obstacles(
    file: Path | None,
    leaf: float,
    radii: bool,
    scene_file: Path | None = None,
    robot: pdoik.Robot | None = None,
    *,
    frame: str | None = None,
    without: Sequence[str] = (),
) -> Obstacles | None:
    """Read a cloud, downsample it, and read a scene; leaves with status 2 when that cannot be done.

    Args:
        file: Of points; None for none.
        leaf: Edge of the cells [m]; 0 keeps every point. A scene's own cloud has its own.
        radii: Give the points that are kept radii that cover those that are not.
        scene_file: Of shapes and perhaps points; None for none.
        robot: Which is no obstacle where the scene has it; None if nobody knows it.
        frame: Of the scene, that of the robot's base; None for the robot's own.
        without: What of the scene is left out.

    Returns:
        None where there are neither.
    """
    if not leaf >= 0:
        fail(f"--leaf: expected metres, at least 0, got {leaf}")
    for option, given in (("--frame", frame is not None), ("--without", len(without) > 0)):
        if given and scene_file is None:
            fail(f"{option}: is of a scene; give --scene FILE, too")
    with misuse_fails():
        scene = None if scene_file is None else _read_scene(scene_file, robot, frame, without)
    if file is None:
        if scene is None:
            return None
        return Obstacles(
            file=scene.path,
            leaf=scene.leaf,
            surface=scene.surface,
            cloud=scene.thinned(),
            scene=scene,
        )
    with misuse_fails():
        surface = load_cloud(file)
    farthest = float(np.abs(surface).max())
    if farthest > _FARTHEST_LIKELY:
        warn(f"{file} has coordinates up to {farthest:.0f} m: are they millimetres?")
    with misuse_fails(f"--leaf {leaf:g}"):
        cloud = pdoik.voxel_downsample(surface, leaf, radii) if leaf > 0 else surface
    if scene is not None and len(scene.surface):
        surface = np.concatenate([surface, scene.surface])
        cloud = np.concatenate([_with_radii(cloud), _with_radii(scene.thinned())])
    return Obstacles(file=file, leaf=leaf, surface=surface, cloud=cloud, scene=scene)


def check_files(cloud: Path | None, scene: Path | None) -> None:
    """Leave with status 2 where one is not there, before there is much to do."""
    for option, path in (("--cloud", cloud), ("--scene", scene)):
        if path is not None and not at_home(path).is_file():
            fail(f"{option} {path}: no such file")


def _read_scene(
    file: Path, robot: pdoik.Robot | None, frame: str | None, without: Sequence[str]
) -> SceneFile:
    """A scene without the robot; what is odd about it and what it leaves out is reported."""
    with warnings_given(pdoik.ObstacleWarning):
        scene = read_scene_file(file, robot=robot, frame=frame, without=without)
    if out := scene.left_out:
        more = f" and {len(out) - 6} more" if len(out) > 6 else ""
        tell(f"{file}: without {', '.join(out[:6])}{more}")
    return scene


def _with_radii(points: FloatArray) -> FloatArray:
    """Points as rows of four, (K, 4), where they have no radius with a zero."""
    return points if points.shape[1] == 4 else np.column_stack([points, np.zeros(len(points))])
