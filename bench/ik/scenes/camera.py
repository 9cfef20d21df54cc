"""What a depth camera sees of meshes: one side of what is not hidden, noise, dropouts."""

from collections.abc import Sequence

import numpy as np
import trimesh
from scipy import ndimage

from bench.common.arrays import FloatArray

WIDTH, HEIGHT = 320, 240  # pixels
FIELD_OF_VIEW = np.radians(70.0)  # horizontal
NOISE = 0.001  # standard deviation of depth at 1 m, growing with its square [m]
DROPOUT = 0.02  # share of pixels without a reading
LOOK_AT = (0.0, 0.0, 0.5)  # [m]
DISTANCE = (1.6, 2.2)  # from there [m]
SAMPLES = 60_000  # surface points that are projected, over all meshes


def depth_view(meshes: Sequence[FloatArray], rng: np.random.Generator) -> FloatArray:
    """The cloud from a random place around, by z-buffer over points drawn from the surfaces.

    Of meshes by triangles, (T, 3, 3) each [m], one point per pixel with a reading, in the meshes'
    frame, (N, 3) [m].
    """
    triangles = np.concatenate(meshes)
    mesh = trimesh.Trimesh(**trimesh.triangles.to_kwargs(triangles), process=False)
    points, _ = trimesh.sample.sample_surface(mesh, SAMPLES, seed=int(rng.integers(2**31)))
    eye, R = _random_place(rng)
    local = (np.asarray(points) - eye) @ R  # x right, y down, z ahead
    focal = WIDTH / 2 / np.tan(FIELD_OF_VIEW / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.floor(focal * local[:, 0] / local[:, 2] + WIDTH / 2)
        v = np.floor(focal * local[:, 1] / local[:, 2] + HEIGHT / 2)
    seen = (local[:, 2] > 0.1) & (u >= 0) & (u < WIDTH) & (v >= 0) & (v < HEIGHT)
    local, pixel = local[seen], (v[seen] * WIDTH + u[seen]).astype(np.int64)
    nearest = np.full(WIDTH * HEIGHT, np.inf)
    np.minimum.at(nearest, pixel, local[:, 2])
    # Samples are sparser than pixels in places: what lies well behind a neighbour is hidden.
    image = nearest.reshape(HEIGHT, WIDTH)
    front = ndimage.minimum_filter(image, size=3, mode="constant", cval=np.inf).ravel()
    visible = (local[:, 2] <= nearest[pixel]) & (local[:, 2] < front[pixel] + 0.05)
    local = local[visible & (rng.uniform(size=len(local)) > DROPOUT)]
    noise = rng.normal(0.0, NOISE, len(local)) * local[:, 2] ** 2
    local = local * (1.0 + noise / local[:, 2])[:, None]  # along the ray
    return np.asarray(local @ R.T + eye)


def _random_place(rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Where the camera is, (3,) [m], and its axes as columns, (3, 3)."""
    azimuth, elevation = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 1.0)
    flat = np.cos(elevation)
    back = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
    ahead = -back
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    R = np.column_stack([right, np.cross(ahead, right), ahead])
    return np.array(LOOK_AT) + rng.uniform(*DISTANCE) * back, R
