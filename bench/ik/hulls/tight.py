"""Fit capsules and pieces to the shipped robots' published meshes, and measure the capsules.

python -m bench.ik.hulls.tight panda ur10 iiwa14 h1           measure the shipped files
python -m bench.ik.hulls.tight panda ur10 iiwa14 h1 --fit     fit anew, write and measure
python -m bench.ik.hulls.tight panda ur10 iiwa14 h1 --pieces  make the pieces anew and write them
python -m bench.ik.hulls.tight panda ur10 iiwa14 h1 --pairs   write which links may touch
"""

import re
import time
from concurrent.futures import ProcessPoolExecutor
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import trimesh
import typer
import yaml

import pdoik
from bench.common.arrays import FloatArray
from bench.common.whole_files import write_text
from bench.humanoid.hulls import circumscribed, distance, turn_of_z
from bench.ik.experiment import Arm
from bench.ik.judges.arm_meshes import arm_meshes
from pdoik.link_pairs import sample_pairs
from pdoik.occupancy_fit import (
    MARGIN,
    Capsule,
    Capsules,
    FitReport,
    OccupancyFit,
    Piece,
    Solid,
    fit_link,
    fit_pieces,
    overhang_of,
    spread,
    tidy_point,
)
from pdoik.view.h1_shapes import SHAPES, Shape

Shipped = StrEnum("Shipped", ["panda", "ur10", "iiwa14", "h1"])
FOLDER = Path(__file__).parents[3] / "cpp/robots"
MAY_TOUCH = {  # though the geometry meets
    "panda": [("panda_link5", "panda_link7")],  # by the maker's SRDF
    "h1": [("torso_link", f"{side}_shoulder_roll_link") for side in ("left", "right")],  # at rest
}
HEADER = """\
#
# Capsules: a second, closer cover of the same geometry, as it is instead of its convex hull, by
#
#   bench/ik/hulls/tight.py {name} --fit
#
# Overhang [mm]: from the outer surface of a link's capsules to its geometry.
#
#   link                 capsules    mean   worst
"""
SIDES = 120  # of the prism around a cylinder
LinkRow = tuple[str, int, float, float]  # capsules, mean and worst overhang [mm]


def geometry(name: str) -> dict[str, FloatArray]:
    """Triangles per link, (T, 3, 3) in our link's frame [m]."""
    if name != "h1":
        return arm_meshes(Arm.builtin(name))
    return {
        link: np.concatenate([circumscribed(shape) for shape in SHAPES if shape.link == link])
        for link in dict.fromkeys(shape.link for shape in SHAPES)
    }


def fit(name: str, meshes: dict[str, FloatArray]) -> list[Capsule]:
    """Capsules of every link. The H1's shapes are capsules and balls already, but for cylinders."""
    capsules: list[Capsule] = []
    if name != "h1":
        for link, mesh in meshes.items():
            capsules += fit_link(link, mesh)[0]
            print(f"{link}: {len(capsules)} capsules so far", flush=True)
        return capsules
    for shape in SHAPES:
        if shape.kind == "cylinder":
            capsules += fit_link(shape.link, circumscribed(shape))[0]
        else:
            a, b = tidy_point(np.array(shape.a)), tidy_point(np.array(shape.b))
            capsules.append(Capsule(shape.link, a, b, round(shape.radius + MARGIN, 9)))
    return capsules


def read(name: str) -> list[Capsule]:
    """Those of the shipped file."""
    rows = yaml.safe_load((FOLDER / f"{name}.occupancy.yaml").read_text("utf-8"))["capsules"]
    return [Capsule(**{**row, "a": tuple(row["a"]), "b": tuple(row["b"])}) for row in rows]


def measure(meshes: dict[str, FloatArray], capsules: list[Capsule]) -> list[LinkRow]:
    """How far each link's capsules stick out."""
    rows = []
    for link, mesh in meshes.items():
        own = [hull for hull in capsules if hull.link == link]
        a, b, radius = (np.array([hull[i] for hull in own]) for i in (1, 2, 3))
        out = overhang_of(Solid.of(mesh), Capsules(a, b, radius))
        rows.append((link, len(own), 1e3 * out.mean, 1e3 * out.worst))
    return rows


def make_pieces(name: str, meshes: dict[str, FloatArray]) -> list[Piece]:
    """Pieces of every link that its capsules are not already, two links at a time."""
    with ProcessPoolExecutor(2) as pool:
        found = list(pool.map(_pieces_of, [name] * len(meshes), meshes, meshes.values()))
    pieces = [piece for of_link in found for piece in of_link]
    worst = max(piece.tolerance for piece in pieces)
    print(f"{name}: {len(pieces)} pieces, {1e3 * worst:.2f} mm beyond their links at most")
    return pieces


def _pieces_of(name: str, link: str, mesh: FloatArray) -> list[Piece]:
    if name != "h1":
        return fit_pieces(link, mesh)
    shapes = [shape for shape in SHAPES if shape.link == link]
    if all(shape.kind != "cylinder" for shape in shapes):
        return []
    return [_around(shape) for shape in shapes]


def _around(shape: Shape) -> Piece:
    """A polytope of few corners around a capsule, a cylinder or a ball."""
    a, b = np.array(shape.a), np.array(shape.b)
    if shape.kind == "cylinder":
        angles = 2 * np.pi * np.arange(SIDES) / SIDES
        ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
        corners = shape.radius / np.cos(np.pi / SIDES) * ring @ turn_of_z(b - a).T
    else:
        ball = trimesh.creation.icosphere(subdivisions=2)
        inner = np.einsum("fi,fi->f", ball.face_normals, ball.triangles[:, 0]).min()
        corners = shape.radius / inner * ball.vertices
    (piece,) = fit_pieces(
        shape.link, trimesh.convex.convex_hull(np.concatenate([a + corners, b + corners])).triangles
    )
    surface = np.array(piece.vertices)[np.array(piece.triangles)]
    out = distance(shape, spread(surface, 20_000)[0]).max()
    return piece._replace(tolerance=round(float(out) + 5e-7, 6))


def write_pieces(name: str, pieces: list[Piece]) -> None:
    """Put them at the end of the robot's file."""
    path = FOLDER / f"{name}.occupancy.yaml"
    text = path.read_text("utf-8").partition("\npieces:\n")[0].rstrip("\n") + "\n"
    report = FitReport(hulls=(), links=(), skipped=())
    only = OccupancyFit(spheres=(), spheroids=(), capsules=(), pieces=tuple(pieces), report=report)
    write_text(path, text + "pieces:\n" + only.to_yaml().partition("pieces:\n")[2])


def write(name: str, capsules: list[Capsule], rows: list[LinkRow]) -> None:
    """Put the list behind the wide hulls, without pieces, and its table at the header's end."""
    path = FOLDER / f"{name}.occupancy.yaml"
    text = re.sub(r"^capsules:\n(?:.*\n)*", "", path.read_text("utf-8"), flags=re.MULTILINE)
    text = re.sub(r"#\n# Capsules:(?:.*\n)*?(?=[a-z])", "", text)
    table = "".join(
        f"#   {link:<22}{n:>7}{mean:>8.2f}{worst:>8.1f}\n" for link, n, mean, worst in rows
    )
    report = FitReport(hulls=(), links=(), skipped=())
    only = OccupancyFit(spheres=(), spheroids=(), capsules=tuple(capsules), report=report)
    listed = only.to_yaml().partition("capsules:\n")[2]
    head, spheres, rest = text.partition("spheres:")
    text = head + HEADER.format(name=name) + table + spheres + rest
    write_text(path, f"{text}capsules:\n{listed}")


def write_pairs(name: str, meshes: dict[str, FloatArray]) -> None:
    """Put the pairs that `pdoik pairs` would leave out into the robot's SRDF."""
    robot = pdoik.Robot.builtin(name)
    robot.occupancy = pdoik.Occupancy.load(FOLDER / f"{name}.occupancy.yaml")
    robot.ignored_pairs = MAY_TOUCH.get(name, [])
    report = sample_pairs(robot, meshes)
    report.write(FOLDER / f"{name}.srdf")
    print(f"{name}: {len(report.ignored)} pairs, refuses {100 * report.flagged_share:.2f} %")


def main(
    robots: list[Shipped],
    anew: Annotated[bool, typer.Option("--fit", help="Fit anew and write the files.")] = False,
    pieces: Annotated[bool, typer.Option("--pieces", help="Make pieces and write them.")] = False,
    pairs: Annotated[bool, typer.Option("--pairs", help="Write the SRDFs.")] = False,
) -> None:
    """Fit capsules to the shipped robots' published meshes, and measure how far they stick out."""
    for name in robots:
        meshes = geometry(name)
        if pairs:
            write_pairs(name, meshes)
            continue
        start = time.process_time()
        capsules = fit(name, meshes) if anew else read(name)
        seconds = time.process_time() - start
        rows = measure(meshes, capsules)
        if anew:
            write(name, capsules, rows)
        if anew or pieces:
            write_pieces(name, make_pieces(name, meshes))
        for link, n, mean, worst in rows:
            print(f"{link:<28}{n:>5}{mean:>8.2f}{worst:>8.1f}")
        print(f"{name}: {len(capsules)} capsules, {seconds:.0f} s of one processor", flush=True)


if __name__ == "__main__":
    typer.run(main)
