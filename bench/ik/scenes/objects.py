"""Cluttered scenes as in the paper's first experiment: objects of everyday size, placed at random.

Object centres are uniform in [-0.6, 0.6] x [-0.6, 0.6] x [0, 1.2] m, orientations uniform over all
rotations, scales uniform in [1, 3]. The objects are primitives, or the YCB objects when a folder
with their clouds is at hand.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import trimesh

import pdoik
from bench.common.arrays import FloatArray, moved
from bench.ik.scenes.primitives import EVERYDAY_OBJECTS, sample_surface, surface_mesh
from pdoik.clouds import load_cloud

CENTER_LOWER = (-0.6, -0.6, 0.0)  # [m]
CENTER_UPPER = (0.6, 0.6, 1.2)  # [m]
SCALES = (1.0, 3.0)
POINTS_PER_OBJECT = 4000


class SceneError(RuntimeError):
    """No scene could be made as asked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectModel:
    """An object as a cloud of its surface, about the middle of the cloud's bounding box."""

    name: str
    points: FloatArray  # (N, 3), [m]
    triangles: FloatArray = field(default_factory=lambda: np.empty((0, 3, 3)))
    """The surface as a mesh in the same frame, (T, 3, 3) [m], where one is known."""

    @property
    def size(self) -> FloatArray:
        """Edges of its bounding box, (3,) [m]."""
        return np.asarray(np.ptp(self.points, axis=0))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedObject:
    """A scaled object in the robot's base frame."""

    model: ObjectModel
    T_base_object: FloatArray  # (4, 4)
    scale: float

    @property
    def points(self) -> FloatArray:
        """Points of its surface in the base frame, (N, 3) [m]."""
        return self._placed(self.model.points)

    @property
    def triangles(self) -> FloatArray:
        """Triangles of its mesh in the base frame, (T, 3, 3) [m]."""
        return self._placed(self.model.triangles)

    def _placed(self, points: FloatArray) -> FloatArray:
        return moved(self.scale * points, self.T_base_object)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Objects around a robot."""

    objects: tuple[PlacedObject, ...]

    @property
    def points(self) -> FloatArray:
        """All surfaces in the base frame, (N, 3) [m]."""
        if not self.objects:
            return np.empty((0, 3))
        return np.concatenate([placed.points for placed in self.objects])

    def cloud(self, leaf: float) -> FloatArray:
        """One point for each cell of a grid over the whole scene (PCL's VoxelGrid), (K, 3) [m]."""
        return pdoik.voxel_downsample(self.points, leaf)


def primitive_models(seed: int = 0, n_points: int = POINTS_PER_OBJECT) -> tuple[ObjectModel, ...]:
    """Boxes, cans, bottles, balls, plates and cups of everyday size, their surfaces sampled."""
    rng = np.random.default_rng(seed)
    return tuple(
        _centered(name, sample_surface(patches, n_points, rng), surface_mesh(patches))
        for name, patches in EVERYDAY_OBJECTS.items()
    )


def ycb_models(folder: str | Path) -> tuple[ObjectModel, ...]:
    """The scanned objects of folder/cloud_vertices/*.pcd and folder/mesh/*.stl, by name.

    Raises:
        SceneError: There are none.
        pdoik.LoadError: One of them cannot be read.
    """
    folder = Path(folder)
    files = sorted((folder / "cloud_vertices").glob("*.pcd"))
    if not files:
        raise SceneError(f"{folder}: expected point clouds in cloud_vertices/*.pcd, got none")
    return tuple(
        _centered(file.stem, load_cloud(file), _read_mesh(folder / "mesh" / f"{file.stem}.stl"))
        for file in files
    )


def _read_mesh(file: Path) -> FloatArray:
    if not file.is_file():
        return np.empty((0, 3, 3))
    return np.asarray(trimesh.load_mesh(file).triangles, dtype=np.float64)


def random_rotation(rng: np.random.Generator) -> FloatArray:
    """A rotation matrix, uniform over all of them: a normalised Gaussian quaternion."""
    w, x, y, z = (wxyz := rng.normal(size=4)) / np.linalg.norm(wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def random_object(rng: np.random.Generator, models: Sequence[ObjectModel]) -> PlacedObject:
    """One of the models at a random pose and scale."""
    T = np.eye(4)
    T[:3, :3] = random_rotation(rng)
    T[:3, 3] = rng.uniform(CENTER_LOWER, CENTER_UPPER)
    model = models[int(rng.integers(len(models)))]
    return PlacedObject(model=model, T_base_object=T, scale=float(rng.uniform(*SCALES)))


def random_scene(
    rng: np.random.Generator,
    models: Sequence[ObjectModel],
    n_objects: int,
    is_clear: Callable[[Scene], bool] = lambda scene: True,
    max_draws: int = 1000,
) -> Scene:
    """Objects drawn one after the other; one that makes the scene unclear is drawn again.

    So scenes stay as full as asked, whatever the robot's posture leaves free. `is_clear` says of
    the scene so far whether it may stay.

    Raises:
        SceneError: `max_draws` objects in a row made the scene unclear.
    """
    scene = Scene(objects=())
    for k in range(n_objects):
        for _ in range(max_draws):
            larger = Scene(objects=(*scene.objects, random_object(rng, models)))
            if is_clear(larger):
                scene = larger
                break
        else:
            said = f"{max_draws} draws, none of them clear"
            raise SceneError(f"object {k + 1} of {n_objects}: {said}")
    return scene


def _centered(name: str, points: FloatArray, triangles: FloatArray) -> ObjectModel:
    center: FloatArray = (points.min(axis=0) + points.max(axis=0)) / 2
    return ObjectModel(name=name, points=points - center, triangles=triangles - center)
