"""Fit the hulls of the Unitree H1 to the shapes of its MuJoCo model, and measure how well they fit.

python -m bench.humanoid.hulls           measure the shipped file
python -m bench.humanoid.hulls --fit     fit anew, write and measure it
"""

import itertools
import textwrap
from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np
import trimesh
import typer
import yaml
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.humanoid.world.robot import OCCUPANCY
from pdoik.occupancy_fit import (
    FitReport,
    OccupancyFit,
    Spheroid,
    clip,
    half_sum,
    rough_shapes,
    tidy_point,
)
from pdoik.occupancy_fit import hulls as fitting  # inside: its steps are timed one by one
from pdoik.view.h1_shapes import SHAPES, Shape

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

Geometry: the capsules, cylinders and balls of pdoik.view.h1_shapes (figures after MuJoCo Menagerie
and Unitree, BSD-3-Clause). A fit by bench.humanoid.hulls --fit: around each part of a link
the spheroid that sticks out least.

Every shape, surface and inside, lies within its link's hulls. Worst gap: of {samples} points and
more on each shape, how far the worst is outside the hulls (negative: all are inside by as much).
Excess: from the hulls' surface to the nearest of the link's shapes. Right limbs mirror the left.

  {columns}
{rows}"""


class Hull(NamedTuple):
    """A hull on one link: a spheroid, or a ball where the foci coincide [m]."""

    link: str
    focus_a: FloatArray
    focus_b: FloatArray
    semi_major: float

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
        semi_minor = np.sqrt(self.semi_major**2 - c**2)
        R = turn_of_z(half / c if c > 0 else np.array([0.0, 0.0, 1.0]))
        ball *= [semi_minor, semi_minor, self.semi_major]
        return ball @ R.T + (self.focus_a + self.focus_b) / 2


def turn_of_z(axis: FloatArray) -> FloatArray:
    """The shortest rotation that takes z to an axis, (3, 3)."""
    return np.asarray(Rotation.align_vectors(axis[None], [[0, 0, 1]])[0].as_matrix())


def read_hulls() -> list[Hull]:
    """Those of the shipped file; each sits on one link."""
    content = yaml.safe_load(OCCUPANCY.read_text())
    rows = [(h["link"], h["center"], h["center"], h["radius"]) for h in content["spheres"]]
    rows += [
        (h["link_a"], h["focus_a"], h["focus_b"], h["semi_major"]) for h in content["spheroids"]
    ]
    assert all(h["link_a"] == h["link_b"] for h in content["spheroids"])
    return [Hull(link, np.array(a), np.array(b), semi_major) for link, a, b, semi_major in rows]


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
    T[:3, :3], T[:3, 3] = turn_of_z(axis), (a + b) / 2
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
    surfaces = []
    for hull in own:
        surface = hull.surface(SAMPLES)
        others = [other.outside(surface) for other in own if other is not hull]
        surfaces.append(surface[np.min(others, axis=0) > 0] if others else surface)
    return to_shapes(np.concatenate(surfaces), link_shapes(link))


def to_shapes(points: FloatArray, shapes: list[Shape]) -> FloatArray:
    """Distances to the nearest of them, (N,) [m]."""
    return np.asarray(np.min([distance(shape, points) for shape in shapes], axis=0))


def distance(shape: Shape, points: FloatArray) -> FloatArray:
    """Signed distance of points (N, 3) in the link's frame to the surface, (N,) [m]."""
    a, b = np.array(shape.a), np.array(shape.b)
    if shape.kind == "sphere":
        return np.asarray(np.linalg.norm(points - a, axis=1) - shape.radius)
    length = float(np.linalg.norm(b - a))
    along = (points - a) @ (b - a) / length
    if shape.kind == "capsule":
        foot = a + np.clip(along, 0, length)[:, None] * (b - a) / length
        return np.asarray(np.linalg.norm(points - foot, axis=1) - shape.radius)
    off_axis = np.linalg.norm(points - a - along[:, None] * (b - a) / length, axis=1)
    q = np.column_stack([off_axis - shape.radius, np.abs(along - length / 2) - length / 2])
    outside = np.linalg.norm(np.maximum(q, 0), axis=1)
    return np.asarray(outside + np.minimum(q.max(axis=1), 0))


def link_shapes(link: str) -> list[Shape]:
    """In the order in which PARTS counts them."""
    return [shape for shape in SHAPES if shape.link == link]


def fit() -> list[Hull]:
    """A hull around each part; the left half and the middle are fitted, the right half mirrored."""
    hulls = []
    for link, which, cuts in PARTS:
        shapes = [link_shapes(link)[k] for k in which]
        for part in _cut(np.concatenate([circumscribed(shape) for shape in shapes]), cuts):
            hull = _around(link, part, shapes)
            hulls.append(hull)
            if "left_" in link:
                flip = np.array([1, -1, 1])
                foci = flip * hull.focus_a, flip * hull.focus_b
                hulls.append(Hull(link.replace("left_", "right_"), *foci, hull.semi_major))
    order = list(dict.fromkeys(shape.link for shape in SHAPES))
    return sorted(hulls, key=lambda hull: order.index(hull.link))


def circumscribed(shape: Shape) -> FloatArray:
    """Triangles of a mesh around the shape, (T, 3, 3) [m]: a fine one, a little thicker."""
    thicker = replace(shape, radius=shape.radius / np.cos(np.pi / SECTIONS) ** 2)
    return np.asarray(shape_mesh(thicker).triangles)


def _cut(triangles: FloatArray, cuts: tuple[float, ...]) -> Iterator[FloatArray]:
    """The pieces between planes across the longest axis of the box around them, (N, 3) each."""
    axis = np.eye(3)[np.argmax(np.ptp(triangles.reshape(-1, 3), axis=0))]
    for lower, upper in itertools.pairwise([None, *cuts, None]):
        part = triangles if lower is None else clip(triangles, axis, lower)
        part = part if upper is None else clip(part, -axis, -upper)
        yield part.reshape(-1, 3)


def _around(link: str, points: FloatArray, shapes: list[Shape]) -> Hull:
    """The spheroid around the points that sticks out least: least mean square of its excess.

    Starts from the one of least volume, whose tips reach far out.
    """
    corners = fitting.extreme_points(points)
    (start,) = rough_shapes(corners[None])

    def hull_of(foci: FloatArray) -> Hull:
        shape = fitting.around(corners, foci[:3], foci[3:])
        return Hull(link, shape.focus_a, shape.focus_b, shape.semi_major)

    def cost(foci: FloatArray) -> float:
        return float(np.mean(to_shapes(hull_of(foci).surface(300), shapes) ** 4))

    foci = np.concatenate([start.focus_a, start.focus_b])
    simplex = {"initial_simplex": np.vstack([foci, foci + 0.01 * np.eye(6)])}
    found = minimize(cost, foci, method="Nelder-Mead", options={**simplex, "maxfev": 1500})
    return hull_of(np.array(tidy_point(found.x[:3]) + tidy_point(found.x[3:])))


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
    rows = textwrap.indent(table(hulls), "  ")
    header = HEADER.format(n=len(hulls), samples=SAMPLES, columns=COLUMNS, rows=rows)
    spheroids = tuple(
        Spheroid(link, tidy_point(a), link, tidy_point(b), semi_major)
        for link, a, b, semi_major in hulls
    )
    report = FitReport(hulls=(), links=(), skipped=())
    OccupancyFit(spheres=(), spheroids=spheroids, report=report).write(OCCUPANCY, header)


def main(
    anew: Annotated[bool, typer.Option("--fit", help="Fit anew and write the file.")] = False,
) -> None:
    """Fit the hulls of the Unitree H1, and measure how well they fit."""
    if anew:
        write(fit())
    hulls = read_hulls()
    print(f"{len(hulls)} hulls\n{COLUMNS}\n{table(hulls)}")


if __name__ == "__main__":
    typer.run(main)
