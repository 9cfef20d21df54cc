"""What self-collision by hulls refuses of free configurations and misses of colliding ones.

    python -m bench.ik.hulls.self_pairs --samples 5000

Hulls fitted to meshes (`pdoik occupancy`) with the pairs of `pdoik pairs`, with and without the
robot's SRDF, and the shipped hulls with the shipped pairs, with their pieces and by capsules alone;
coal on the published collision meshes is the judge, on configurations that the pairs were not found
by.
"""

from collections.abc import Mapping
from typing import Annotated

import numpy as np
import typer

import pdoik
from bench.common.arrays import FloatArray
from bench.common.markdown import markdown_table
from bench.humanoid.hulls import shape_mesh
from bench.ik.experiment import ARMS, Arm
from bench.ik.judges.arm_meshes import arm_meshes
from bench.ik.judges.meshes import self_judge
from bench.ik.problems.hulls import fitted_robot
from bench.ik.problems.robots import robot_files
from pdoik.link_pairs import sample_pairs
from pdoik.occupancy_fit import load_geometry
from pdoik.view.h1_shapes import SHAPES

CLEARANCES = (0.0, -0.002, -0.004)  # [m]
COLUMNS = ("robot", "hulls", "pairs left out", "free", "clearance [mm]", "refused", "missed")


def main(
    samples: Annotated[int, typer.Option(help="Configurations to judge.")] = 5000,
    seed: Annotated[int, typer.Option(help="Of these; the pairs are found with another.")] = 1,
    shipped: Annotated[bool, typer.Option("--shipped", help="Of shipped hulls alone.")] = False,
) -> None:
    """Print the table."""
    rows = []
    for name in () if shipped else ("panda", "ur10"):
        files = robot_files(name)
        meshes = {m.name: m.triangles for m in load_geometry(files.xml(), files.package_dirs)}
        robot = fitted_robot(files)
        listed = {"nothing": []}
        if files.srdf is not None:
            listed["its SRDF"] = pdoik.load_srdf_pairs(files.srdf, robot)
        for word, given in listed.items():
            robot.ignored_pairs = []
            found = sample_pairs(robot, files.xml(), files.package_dirs, listed=given)
            robot.ignored_pairs = found.ignored
            rows += _judge(robot, meshes, samples, seed, [name, "fitted", f"{word}, sampled"])
    for name in (*ARMS, "h1"):
        robot, meshes = pdoik.Robot.builtin(name), _meshes(name)
        for exact, words in ((False, "shipped, capsules alone"), (True, "shipped")):
            rows += _judge(robot, meshes, samples, seed, [name, words, "shipped"], exact=exact)
    print(markdown_table(COLUMNS, rows))


def _meshes(name: str) -> dict[str, FloatArray]:
    """Meshes of a shipped robot; the H1's have their corners on the surfaces of its shapes."""
    if name != "h1":
        return arm_meshes(Arm.builtin(name))
    return {
        link: np.concatenate([shape_mesh(each).triangles for each in SHAPES if each.link == link])
        for link in dict.fromkeys(shape.link for shape in SHAPES)
    }


def _judge(
    robot: pdoik.Robot,
    meshes: Mapping[str, FloatArray],
    samples: int,
    seed: int,
    words: list[str],
    *,
    exact: bool = True,
) -> list[list[str]]:
    solver = pdoik.Solver(robot, pdoik.Options(self_collision=True, exact_contact=exact))
    goals = {tip: np.eye(4) for tip in robot.tip_links}
    drawn = np.random.default_rng(seed).uniform(robot.lower, robot.upper, (samples, robot.dof))
    distance = np.array([solver.judge(goals, q).self_distance for q in drawn])
    collides = np.array(list(map(self_judge(robot, meshes), drawn)))
    free = ~collides
    return [
        [
            *words,
            f"{free.mean():.3f}",
            f"{1e3 * clearance:g}",
            f"{(distance[free] < clearance).mean():.4f}",
            f"{(distance[collides] >= clearance).sum()} / {collides.sum()}",
        ]
        for clearance in CLEARANCES
    ]


if __name__ == "__main__":
    typer.run(main)
