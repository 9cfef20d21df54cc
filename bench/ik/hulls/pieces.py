"""What links' own pieces change: solves among boxes and points, with and without, in turns.

    python -m bench.ik.hulls.pieces panda ur10 iiwa14 --count 240

The shipped robots, with their pieces and by their capsules alone. Boxes stand around a
configuration that touches none by the meshes, so that each problem has a solution; answers are
judged by coal on the published collision meshes.
"""

import time
from enum import StrEnum
from typing import Annotated

import numpy as np
import typer
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.markdown import markdown_table
from bench.ik.experiment import ARMS
from bench.ik.judges.meshes import Body
from bench.ik.problems.solids import Solid
from bench.ik.scenes.around import itself_judge, mesh_judge

Robot = StrEnum("Robot", ARMS)
BOXES = 9
SPREADS = {"boxes": 0.25, "tight boxes": 0.12, "points": 0.12}  # of a box about a link [m]
LEAF = 0.01  # of the points' radii [m]
TURNS = 3
COLUMNS = (
    "robot",
    "scenes",
    "hulls",
    "solved",
    "wrong",
    "median [us]",
    "p95 [us]",
    "over capsules'",
)


def main(
    robots: Annotated[list[Robot] | None, typer.Argument(help="Which; all by default.")] = None,
    count: Annotated[int, typer.Option(min=1, help="Problems of each kind.")] = 240,
    seed: Annotated[int, typer.Option(min=0)] = 1,
) -> None:
    """Print the table."""
    rows = []
    for robot in robots or list(Robot):
        own = pdoik.Robot.builtin(robot)
        solvers = {
            "pieces": pdoik.Solver(own),
            "capsules": pdoik.Solver(own, pdoik.Options(exact_contact=False)),
        }
        for kind, spread in SPREADS.items():
            rng = np.random.default_rng(seed)
            outcomes = [_problem(solvers, robot, kind, spread, rng) for _ in range(count)]
            for name in solvers:
                times = np.array([outcome[name][2] for outcome in outcomes])
                ratio = times / np.array([outcome["capsules"][2] for outcome in outcomes])
                rows.append(
                    [
                        robot,
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


def _problem(
    solvers: dict[str, pdoik.Solver],
    arm: str,
    kind: str,
    spread: float,
    rng: np.random.Generator,
) -> dict[str, tuple[bool, bool, float]]:
    """Says of each solver whether it solved, whether wrongly, and its least time [s]."""
    robot, meshes, touches_itself = solvers["pieces"].robot, mesh_judge(arm), itself_judge(arm)
    while True:
        q = rng.uniform(robot.lower, robot.upper)
        if not touches_itself(q):
            break
    solids: list[Solid] = []
    bodies: list[Body] = []
    while len(solids) < BOXES:
        link = robot.link_names[rng.integers(2, len(robot.link_names))]
        T = np.eye(4)
        T[:3, :3] = Rotation.from_quat(rng.normal(size=4)).as_matrix()
        T[:3, 3] = robot.fk(q, link)[:3, 3] + rng.normal(0, spread, 3)
        solid = Solid(f"box {len(solids)}", "box", tuple(rng.uniform(0.03, 0.15, 3)), T)
        body = Body.of(solid.name, np.asarray(solid.surface().triangles))
        if meshes.collision(q, [body]) is None:
            solids.append(solid)
            bodies.append(body)
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
            wrong = result.success and (
                meshes.collision(result.q, bodies) is not None or touches_itself(result.q)
            )
            before = found.get(name, (False, False, np.inf))
            found[name] = (result.success, wrong, min(before[2], taken))
    return found


if __name__ == "__main__":
    typer.run(main)
