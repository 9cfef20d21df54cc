"""The paper's first experiment by wide hulls and by capsules: the same scenes, in turns.

    python -m bench.ik.hulls.tight_trials panda ur10 iiwa14 --ycb DIR
    python -m bench.ik.hulls.tight_trials ur10 --ycb DIR --bare 0.1 --bare 0.03 --covering 0.03

Scenes are drawn and answers are judged by meshes, so neither hulls are given an advantage. Wide are
the spheres and spheroids of a robot's file, tight its capsules within them. A cloud's points are
given bare, as the paper has them, or as balls that cover the whole scan.
"""

from collections.abc import Sequence
from enum import StrEnum
from itertools import product
from typing import Annotated

import numpy as np
import pandas as pd
import typer

import pdoik
from bench.common.grouped import grouped_table, mean
from bench.ik.experiment import ARMS, Arm
from bench.ik.hulls.tight import FOLDER
from bench.ik.methods import Problem, Terms, make_method
from bench.ik.scenes.around import mesh_judge, models_of, random_scene_around, start_configuration
from bench.ik.success.trials import scenario_seed, verdict

LEAF = 0.1  # of the voxel grid over the clouds, the paper's [m]
METHODS = ("pdoik", "PDO-IK", "PDO-IK, omega = 0")
KEYS = ("arm", "objects", "method", "points", "hulls")


def microseconds(percent: float, digits: int) -> object:
    """Of the solves."""
    return lambda some: f"{np.percentile(1e6 * some.time, percent):.{digits}f} us"


def solves(
    name: str,
    n_objects: int,
    count: int,
    ycb: str | None,
    methods: Sequence[str],
    clouds: Sequence[tuple[str, float]],
) -> pd.DataFrame:
    """A row for each scene, method, kind of points and kind of hulls."""
    terms = Terms()
    wide, tight = Arm.builtin(name), Arm.builtin(name)
    tight.robot.occupancy = pdoik.Occupancy.load(FOLDER / f"{name}.occupancy.yaml")
    solvers = {
        (method, hulls): make_method(method, arm, terms)
        for method in methods
        for hulls, arm in (("wide", wide), ("tight", tight))
    }
    q0, judge, models = start_configuration(wide), mesh_judge(name), models_of(ycb)
    rows = []
    for index in range(count):
        seed = scenario_seed(0, name, n_objects, index)
        q, scene, bodies = random_scene_around(wide, judge, models, n_objects, seed)
        T_base_tip = wide.robot.fk(q)
        for method, (kind, leaf), hulls in product(methods, clouds, ("wide", "tight")):
            cloud = scene.cloud(leaf)
            if kind == "covering":
                cloud = pdoik.voxel_downsample(scene.points, leaf, radii=True)
            problem = Problem(T_base_tip, q0, cloud)
            solver = solvers[method, hulls]
            solver.solve(problem)  # once unseen, so that whoever comes first pays for nothing
            answer = solver.solve(problem)
            said = verdict(name, T_base_tip, bodies, answer, terms)
            points = f"{100 * leaf:g} cm, {kind}"
            row = dict(zip(KEYS, (name, n_objects, method, points, hulls), strict=True))
            rows.append({**row, **said, "claimed": answer.claimed, "time": answer.time})
    return pd.DataFrame(rows)


def main(
    robots: list[StrEnum("Arm", ARMS)],
    ycb: Annotated[str | None, typer.Option(help="Folder with the YCB objects.")] = None,
    scenarios: Annotated[int, typer.Option(help="Per arm and number of objects.")] = 200,
    objects: Annotated[list[int], typer.Option(help="Repeatable.")] = (3, 6, 9),
    methods: Annotated[list[str], typer.Option(help="Repeatable.")] = METHODS,
    bare: Annotated[list[float], typer.Option(help="Leaves [m]; repeatable.")] = (),
    covering: Annotated[list[float], typer.Option(help="Leaves [m]; repeatable.")] = (),
) -> None:
    """The paper's first experiment by wide hulls and by capsules."""
    clouds = [("bare", leaf) for leaf in bare] + [("covering", leaf) for leaf in covering]
    columns = {
        "success": mean("success"),
        "claimed": mean("claimed"),
        "meshes touch": lambda some: (some.claimed & some.fails_collision).sum(),
        "median": microseconds(50, 1),
        "p95": microseconds(95, 0),
    }
    for k, (name, count) in enumerate(product(robots, objects)):
        some = solves(name, count, scenarios, ycb, methods, clouds or [("bare", LEAF)])
        table = grouped_table(some, dict(zip(KEYS, KEYS, strict=True)), columns)
        print("\n".join(table.splitlines()[2 * bool(k) :]), flush=True)


if __name__ == "__main__":
    typer.run(main)
