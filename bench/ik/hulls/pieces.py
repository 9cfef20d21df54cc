"""What links' own pieces change: solves among boxes and points, with and without, in turns.

    python -m bench.ik.hulls.pieces --count 240

A Panda's shipped capsules, and the convex parts of its published collision meshes as pieces. Boxes
stand around a configuration that touches none by the meshes, so that each problem has a solution;
answers are judged by coal on the meshes.
"""

import time
from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np
import typer
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.common.markdown import markdown_table
from bench.ik.problems.judge import Judge
from bench.ik.problems.robots import robot_files
from bench.ik.problems.solids import Solid
from pdoik.occupancy_fit import fit_pieces
from pdoik.occupancy_fit.geometry import load_geometry

BOXES = 9
SPREADS = {"boxes": 0.25, "tight boxes": 0.12, "points": 0.12}  # of a box about a link [m]
LEAF = 0.01  # of the points' radii [m]
TURNS = 3
COLUMNS = ("scenes", "hulls", "solved", "wrong", "median [us]", "p95 [us]", "over capsules'")


def main(
    count: Annotated[int, typer.Option(min=1, help="Problems of each kind.")] = 240,
    seed: Annotated[int, typer.Option(min=0)] = 1,
) -> None:
    """Print the table."""
    files = robot_files("panda")
    judge = Judge(files, "collision")
    capsules, robot = pdoik.Robot.builtin("panda"), pdoik.Robot.builtin("panda")
    links = load_geometry(files.xml(), files.package_dirs)
    robot.occupancy = with_pieces(robot, {link.name: link.triangles for link in links})
    solvers = {"pieces": pdoik.Solver(robot), "capsules": pdoik.Solver(capsules)}
    rows = []
    for kind, spread in SPREADS.items():
        rng = np.random.default_rng(seed)
        outcomes = [_problem(solvers, judge, kind, spread, rng) for _ in range(count)]
        for name in solvers:
            times = np.array([outcome[name][2] for outcome in outcomes])
            ratio = times / np.array([outcome["capsules"][2] for outcome in outcomes])
            rows.append(
                [
                    kind,
                    name,
                    str(sum(outcome[name][0] for outcome in outcomes)),
                    str(sum(outcome[name][1] for outcome in outcomes)),
                    f"{1e6 * np.median(times):.0f}",
                    f"{1e6 * np.percentile(times, 95):.0f}",
                    f"{np.median(ratio):.2f}",
                ]
            )
    print(markdown_table(COLUMNS, rows))


def with_pieces(robot: pdoik.Robot, meshes: Mapping[str, FloatArray]) -> pdoik.Occupancy:
    """The robot's hulls, and pieces of the links that have capsules, by their triangles."""
    own = robot.occupancy
    covered = {link for link, *_ in own.capsules}
    pieces = [
        (piece.link, np.array(piece.vertices), np.array(piece.triangles), piece.tolerance)
        for link, triangles in meshes.items()
        if link in covered
        for piece in fit_pieces(link, triangles)
    ]
    return pdoik.Occupancy(
        spheres=own.spheres, spheroids=own.spheroids, capsules=own.capsules, pieces=pieces
    )


def _problem(
    solvers: dict[str, pdoik.Solver],
    judge: Judge,
    kind: str,
    spread: float,
    rng: np.random.Generator,
) -> dict[str, tuple[bool, bool, float]]:
    """Of each solver: whether it solved, whether wrongly, and its least time [s]."""
    robot = solvers["pieces"].robot
    while True:
        q = rng.uniform(robot.lower, robot.upper)
        if judge.touches_itself(_whole(judge, q)) is None:
            break
    solids: list[Solid] = []
    while len(solids) < BOXES:
        link = robot.link_names[rng.integers(2, len(robot.link_names))]
        T = np.eye(4)
        T[:3, :3] = Rotation.from_quat(rng.normal(size=4)).as_matrix()
        T[:3, 3] = robot.fk(q, link)[:3, 3] + rng.normal(0, spread, 3)
        solid = Solid(f"box {len(solids)}", "box", tuple(rng.uniform(0.03, 0.15, 3)), T)
        if not _touches(judge, q, [solid]):
            solids.append(solid)
    obstacles: object = [pdoik.Shape.box(s.name, s.size, s.T) for s in solids]
    if kind == "points":
        points = np.concatenate([solid.sample(2 * LEAF) for solid in solids])
        obstacles = np.c_[points, np.full(len(points), LEAF)]
    found: dict[str, tuple[bool, bool, float]] = {}
    for _ in range(TURNS):
        for name, solver in solvers.items():
            begun = time.perf_counter()
            result = solver.solve(robot.fk(q), obstacles=obstacles)
            taken = time.perf_counter() - begun
            wrong = result.success and _touches(judge, result.q, solids)
            before = found.get(name, (False, False, np.inf))
            found[name] = (result.success, wrong, min(before[2], taken))
    return found


def _touches(judge: Judge, q: FloatArray, solids: Sequence[Solid]) -> bool:
    """Whether a link does; the hand, which the shipped robot has not, may."""
    what = judge.touching(_whole(judge, q), solids)
    return what is not None and "hand" not in what and "finger" not in what


def _whole(judge: Judge, q: FloatArray) -> FloatArray:
    """With the fingers, which the shipped robot has not, drawn in."""
    return np.concatenate([q, np.zeros(judge.dof - len(q))])


if __name__ == "__main__":
    typer.run(main)
