"""Clouds of a thousand to a million points: as depth cameras give them, and filling the space."""

from pathlib import Path

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.scenes.camera import depth_view
from bench.ik.scenes.objects import primitive_models, random_scene

KINDS = ("camera", "dense")
OBJECTS = 9  # of a camera's scene
KEPT_OFF_THE_BASE = 0.12  # no camera sees points inside the robot's foot, about its axis [m]
DENSE_BOX = ((-0.6, -0.6, 0.0), (0.6, 0.6, 1.2))  # where the arm is [m]


def write_cloud(folder: Path, kind: str, count: int, seed: int) -> Path | None:
    """A file of doubles, x y z row by row; None where no point is wanted.

    "dense" is uniform in a box about the arm: the worst that can come.
    """
    if count == 0:
        return None
    path = folder / f"{kind}-{count}.f64"
    rng = np.random.default_rng([seed, count])
    dense = kind != "camera"
    points = rng.uniform(*DENSE_BOX, (count, 3)) if dense else camera_cloud(count, rng)
    np.ascontiguousarray(points, dtype=np.float64).tofile(path)
    return path


def camera_cloud(count: int, rng: np.random.Generator) -> FloatArray:
    """Everyday objects seen from as many places as it takes, drawn from at random, (count, 3)."""
    scene = random_scene(rng, primitive_models(), OBJECTS)
    meshes = [placed.triangles for placed in scene.objects]
    views: list[FloatArray] = []
    while sum(map(len, views)) < count:
        seen = depth_view(meshes, rng)
        views.append(seen[np.linalg.norm(seen[:, :2], axis=1) > KEPT_OFF_THE_BASE])
    points = np.concatenate(views)
    return np.asarray(points[np.sort(rng.choice(len(points), count, replace=False))])
