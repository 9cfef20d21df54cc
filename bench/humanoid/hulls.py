"""Fit the hulls of the Unitree H1 to the shapes of its MuJoCo model, and measure how well they fit.

python -m bench.humanoid.hulls           measure the shipped file
python -m bench.humanoid.hulls --fit     fit anew, write and measure it
"""

import argparse
import itertools
import textwrap
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import trimesh
import yaml
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from pdoik.h1.robot import OCCUPANCY
from pdoik.h1.shapes import SHAPES, Shape
from pdoik.occupancy_fit import OccupancyFit
from pdoik.occupancy_fit.hulls import (
    Spheroid,
    around,
    extreme_points,
    half_sum,
    smallest_shape,
    tidy_point,
)
from pdoik.occupancy_fit.report import FitReport
from pdoik.occupancy_fit.split import clip

SAMPLES = 4000  # per shape or hull
SECTIONS = 64  # of the meshes' circles

# What a hull is put around: of a link, the shapes by their place in its list, and where these are
# cut across their longest side [m]. A hull per piece.
PARTS: tuple[tuple[str, tuple[int, ...], tuple[float, ...]], ...] = (
    ("torso_link", (0,), ()),
    ("torso_link", (1,), (0.24,)),
    ("torso_link", (2,), (0.24,)),
    ("torso_link", (3, 4), (0.6,)),
    ("left_hip_yaw_link", (0,), ()),
    ("left_hip_roll_link", (0,), ()),
    ("left_hip_pitch_link", (0,), ()),
    ("left_hip_pitch_link", (1, 2, 3), (-0.2,)),
    ("left_knee_link", (0, 1), (-0.2,)),
    ("left_ankle_link", (0, 1), ()),
    ("left_ankle_link", (2,), ()),
    ("left_shoulder_roll_link", (0,), ()),
    ("left_shoulder_yaw_link", (0,), (-0.025,)),
    ("left_elbow_link", (0, 1), (0.15,)),
)

COLUMNS = f"{'link':<26}{'hulls':>6}{'worst gap':>12}{'excess: median':>15}{'max':>7}  [mm]"
HEADER = """\
Hulls of the Unitree H1, all links that have a shape in the MuJoCo model: {n} spheroids.

Geometry: the capsules, cylinders and balls of pdoik.h1.shapes (figures after MuJoCo Menagerie and
Unitree, BSD-3-Clause). A fit by bench.humanoid.hulls --fit: around each part of a link
the spheroid that sticks out least.

Every shape, surface and inside, lies within its link's hulls. Worst gap: of {samples} points and
more on each shape, how far the worst is outside the hulls (negative: all are inside by as much).
Excess: from the hulls' surface to the nearest of the link's shapes. Right limbs mirror the left.

  {columns}
{rows}"""


class Hull:
    """A hull on one link: a spheroid, or a ball where the foci coincide."""

    def __init__(self, link: str, focus_a: FloatArray, focus_b: FloatArray, semi_major: float):
        self.link, self.focus_a, self.focus_b = link, np.array(focus_a), np.array(focus_b)
        self.semi_major = semi_major

    def outside(self, points: FloatArray) -> FloatArray:
        """How far points (N, 3) are outside, at most; negative inside, (N,) [m]."""
        return half_sum(points, self.focus_a, self.focus_b) - self.semi_major

    def surface(self, n: int) -> FloatArray:
        """Points all over the surface, (n, 3) [m]."""
        k = np.arange(n) + 0.5
        z, turn = 1 - 2 * k / n, np.pi * (1 + 5**0.5) * k  # a spiral of even density
        ring = np.sqrt(1 - z**2)
        ball = np.column_stack([ring * np.cos(turn), ring * np.sin(turn), z])
        half = (self.focus_b - self.focus_a) / 2
        c = float(np.linalg.norm(half))
        axis = half / c if c > 0 else np.array([0.0, 0.0, 1.0])
        semi_minor = np.sqrt(self.semi_major**2 - c**2)
        R = Rotation.align_vectors(axis[None], [[0, 0, 1]])[0].as_matrix()
        ball *= [semi_minor, semi_minor, self.semi_major]
        return np.asarray(ball @ R.T + (self.focus_a + self.focus_b) / 2)


def read_hulls() -> list[Hull]:
    """Those of the shipped file; each sits on one link."""
    content = yaml.safe_load(OCCUPANCY.read_text())
    balls = [Hull(h["link"], h["center"], h["center"], h["radius"]) for h in content["spheres"]]
    spheroids = [
        Hull(h["link_a"], h["focus_a"], h["focus_b"], h["semi_major"]) for h in content["spheroids"]
    ]
    assert all(h["link_a"] == h["link_b"] for h in content["spheroids"])
    return balls + spheroids


def shape_surface(shape: Shape, rng: np.random.Generator) -> FloatArray:
    """Points on the surface of a shape, its rims and corners among them, (N, 3) [m]."""
    mesh = shape_mesh(shape)
    points, _ = trimesh.sample.sample_surface(mesh, SAMPLES, seed=int(rng.integers(2**31)))
    return np.concatenate([np.asarray(points), np.asarray(mesh.vertices)])


def shape_mesh(shape: Shape) -> trimesh.Trimesh:
    """A fine mesh with its vertices on the shape's surface."""
    if shape.kind == "sphere":
        mesh = trimesh.creation.icosphere(subdivisions=4, radius=shape.radius)
        mesh.apply_translation(shape.a)
        return mesh
    segment = np.array([shape.a, shape.b])
    if shape.kind == "cylinder":
        return trimesh.creation.cylinder(radius=shape.radius, segment=segment, sections=SECTIONS)
    return capsule_mesh(*segment, shape.radius, SECTIONS)


def capsule_mesh(a: FloatArray, b: FloatArray, radius: float, sections: int) -> trimesh.Trimesh:
    """A mesh of a capsule with its vertices on the surface; a ball where the ends coincide."""
    length = float(np.linalg.norm(b - a))
    axis = (b - a) / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
    mesh = trimesh.creation.capsule(height=length, radius=radius, count=[sections, sections])
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    T = np.eye(4)
    T[:3, :3] = Rotation.align_vectors(axis[None], [[0, 0, 1]])[0].as_matrix()
    T[:3, 3] = (a + b) / 2
    return mesh.apply_transform(T)


def worst_gaps(hulls: list[Hull], seed: int = 0) -> dict[str, float]:
    """Per shape, how far the worst point of its surface is outside its link's hulls, [m]."""
    rng = np.random.default_rng(seed)
    gaps = {}
    for k, shape in enumerate(SHAPES):
        points = shape_surface(shape, rng)
        own = [hull.outside(points) for hull in hulls if hull.link == shape.link]
        gaps[f"{shape.link}_{k}"] = float(np.min(own, axis=0).max())
    return gaps


def excess(hulls: list[Hull], link: str) -> FloatArray:
    """Distances from the surface of a link's hulls, where it is free, to its shapes, (N,) [m]."""
    own = [hull for hull in hulls if hull.link == link]
    points = []
    for hull in own:
        surface = hull.surface(SAMPLES)
        others = [other.outside(surface) for other in own if other is not hull]
        points.append(surface[np.min(others, axis=0) > 0] if others else surface)
    everything = np.concatenate(points)
    shapes = [shape for shape in SHAPES if shape.link == link]
    return np.asarray(np.min([shape.distance(everything) for shape in shapes], axis=0))


def fit() -> list[Hull]:
    """A hull around each part; the left half and the middle are fitted, the right half mirrored."""
    hulls = []
    for link, which, cuts in PARTS:
        shapes = [shape for shape in SHAPES if shape.link == link]
        triangles = np.concatenate([circumscribed(shapes[k]) for k in which])
        for part in _cut(triangles, cuts):
            hull = _around(link, part, [shapes[k] for k in which])
            hulls.append(hull)
            if "left_" in link:
                hulls.append(_mirrored(hull))
    order = list(dict.fromkeys(shape.link for shape in SHAPES))
    return sorted(hulls, key=lambda hull: order.index(hull.link))


def circumscribed(shape: Shape) -> FloatArray:
    """Triangles of a mesh around the shape, (T, 3, 3) [m]: a fine one, a little thicker."""
    thicker = replace(shape, radius=shape.radius / np.cos(np.pi / SECTIONS) ** 2)
    return np.asarray(shape_mesh(thicker).triangles)


def _cut(triangles: FloatArray, cuts: tuple[float, ...]) -> Iterator[FloatArray]:
    """The pieces between planes across the longest axis of the box around them, (N, 3) each."""
    points = triangles.reshape(-1, 3)
    axis = np.eye(3)[np.argmax(np.ptp(points, axis=0))]
    bounds = [-np.inf, *cuts, np.inf]
    for lower, upper in itertools.pairwise(bounds):
        part = triangles
        if np.isfinite(lower):
            part = clip(part, axis, lower)
        if np.isfinite(upper):
            part = clip(part, -axis, -upper)
        yield part.reshape(-1, 3)


def _around(link: str, points: FloatArray, shapes: list[Shape]) -> Hull:
    """The spheroid around the points that sticks out least: least mean square of its excess.

    Starts from the one of least volume, whose tips reach far out.
    """
    corners = extreme_points(points)
    start = smallest_shape(corners, quick=True)

    def hull_of(foci: FloatArray) -> Hull:
        shape = around(corners, foci[:3], foci[3:])
        return Hull(link, shape.focus_a, shape.focus_b, shape.semi_major)

    def cost(foci: FloatArray) -> float:
        surface = hull_of(foci).surface(300)
        return float(np.mean(np.min([shape.distance(surface) for shape in shapes], axis=0) ** 4))

    foci = np.concatenate([start.focus_a, start.focus_b])
    simplex = np.vstack([foci, foci + 0.01 * np.eye(6)])
    found = minimize(
        cost, foci, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": 1500}
    )
    return hull_of(np.array(tidy_point(found.x[:3]) + tidy_point(found.x[3:])))


def _mirrored(hull: Hull) -> Hull:
    flip = np.array([1, -1, 1])
    link = hull.link.replace("left_", "right_")
    return Hull(link, flip * hull.focus_a, flip * hull.focus_b, hull.semi_major)


def table(hulls: list[Hull]) -> str:
    """Per link: hulls, worst gap, excess [mm]; the middle and the left half."""
    gaps = worst_gaps(hulls)
    rows = []
    for link in dict.fromkeys(shape.link for shape in SHAPES):
        if "right_" in link:
            continue
        worst = max(gap for name, gap in gaps.items() if name.startswith(link))
        out = excess(hulls, link)
        count = sum(hull.link == link for hull in hulls)
        median, most = np.median(out), out.max()
        rows.append(
            f"{link:<26}{count:>6}{1e3 * worst:>12.3f}{1e3 * median:>15.1f}{1e3 * most:>7.1f}"
        )
    return "\n".join(rows)


def write(hulls: list[Hull]) -> None:
    """Write the occupancy file, with the table of its fit."""
    header = HEADER.format(
        n=len(hulls), samples=SAMPLES, columns=COLUMNS, rows=textwrap.indent(table(hulls), "  ")
    )
    spheroids = tuple(
        Spheroid(
            hull.link,
            tidy_point(hull.focus_a),
            hull.link,
            tidy_point(hull.focus_b),
            hull.semi_major,
        )
        for hull in hulls
    )
    report = FitReport(hulls=(), links=(), skipped=())
    OccupancyFit(spheres=(), spheroids=spheroids, report=report).write(OCCUPANCY, header)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--fit", action="store_true", help="fit anew and write the file")
    if parser.parse_args().fit:
        write(fit())
    hulls = read_hulls()
    print(f"{len(hulls)} hulls\n{COLUMNS}\n{table(hulls)}")


if __name__ == "__main__":
    main()
