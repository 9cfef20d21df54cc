"""The paper's first experiment by wide hulls and by capsules: the same scenes, in turns.

python -m bench.ik.hulls.tight_trials panda ur10 iiwa14 --ycb DIR
python -m bench.ik.hulls.tight_trials ur10 --ycb DIR --bare 0.1 0.03 --covering 0.03

Scenes are drawn and answers are judged by meshes, so neither hulls are given an advantage. Wide are
the spheres and spheroids of a robot's file, tight its capsules within them. A cloud's points are
given bare, as the paper has them, or as balls that cover the whole scan.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import pdoik
from bench.ik.experiment import ARMS, Arm
from bench.ik.methods import Method, Problem, Terms, make_method
from bench.ik.success.trials import (
    Criteria,
    Scenario,
    models_of,
    random_scene_around,
    scenario_seed,
    start_configuration,
)

ROBOTS = Path(__file__).parents[3] / "cpp/robots"
BARE, COVERING = "bare", "covering"
LEAF = 0.1  # of the voxel grid over the clouds, the paper's [m]
TERMS = Terms(goal_axis="z", position_tolerance=0.01, rotation_tolerance=0.01, max_time=60.0)


def arms_of(name: str) -> dict[str, Arm]:
    """The arm by its wide hulls, and by its file's capsules too."""
    both = {}
    tight = pdoik.Occupancy.load(ROBOTS / f"{name}.occupancy.yaml")
    wide = pdoik.Occupancy(spheres=tight.spheres, spheroids=tight.spheroids)
    for hulls, occupancy in (("wide", wide), ("tight", tight)):
        arm = Arm.builtin(name)
        arm.robot.occupancy = occupancy
        both[hulls] = arm
    return both


def run(
    name: str,
    n_objects: int,
    count: int,
    ycb: str | None,
    methods: Sequence[str],
    clouds: Sequence[tuple[str, float]],
) -> None:
    """Print a row per method, kind of points and kind of hulls."""
    arms = arms_of(name)
    criteria = Criteria.of(arms["wide"])
    solvers: dict[tuple[str, str], Method] = {
        (method, hulls): make_method(method, arm, TERMS)
        for method in methods
        for hulls, arm in arms.items()
    }
    q0 = start_configuration(arms["wide"])
    keys = [(method, *cloud, hulls) for method in methods for cloud in clouds for hulls in arms]
    rows: dict[tuple[str, str, float, str], list[tuple[bool, bool, bool, float]]] = {
        key: [] for key in keys
    }
    for index in range(count):
        seed = scenario_seed(0, name, n_objects, index)
        q, scene, bodies = random_scene_around(
            arms["wide"], criteria.judge, models_of(ycb), n_objects, seed
        )
        T_base_tip = arms["wide"].robot.fk(q)
        for key in keys:
            method, kind, leaf, hulls = key
            cloud = scene.cloud(leaf)
            if kind == COVERING:
                cloud = pdoik.voxel_downsample(scene.points, leaf, radii=True)
            problem = Problem(T_base_tip=T_base_tip, q0=q0, points=cloud)
            scenario = Scenario(q=q, T_base_tip=T_base_tip, objects=bodies, cloud=cloud)
            solver = solvers[method, hulls]
            solver.solve(problem)  # once unseen, so that whoever comes first pays for nothing
            answer = solver.solve(problem)
            verdict = criteria.verdict(scenario, answer, TERMS)
            touches = answer.claimed and verdict["fails_collision"]
            rows[key].append((verdict["success"], answer.claimed, touches, answer.time))
    for (method, kind, leaf, hulls), solves in rows.items():
        success, claimed, touches, times = (
            np.array(column) for column in zip(*solves, strict=True)
        )
        median, p95 = np.percentile(1e6 * times, [50, 95])
        print(
            f"| {name} | {n_objects} | {method} | {100 * leaf:g} cm, {kind} | {hulls}"
            f" | {success.mean():.3f} | {claimed.mean():.3f} | {touches.sum():.0f}"
            f" | {median:.1f} us | {p95:.0f} us |",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("robots", nargs="+", choices=ARMS)
    parser.add_argument("--ycb", help="folder with the YCB objects; primitives without it")
    parser.add_argument("--scenarios", type=int, default=200, help="per arm and number of objects")
    parser.add_argument("--objects", type=int, nargs="+", default=[3, 6, 9])
    parser.add_argument("--methods", nargs="+", default=["pdoik", "PDO-IK", "PDO-IK, omega = 0"])
    parser.add_argument("--bare", type=float, nargs="+", default=[], help="leaves [m]")
    parser.add_argument("--covering", type=float, nargs="+", default=[], help="leaves [m]")
    options = parser.parse_args()
    clouds = [(BARE, leaf) for leaf in options.bare] + [
        (COVERING, leaf) for leaf in options.covering
    ]
    columns = ("arm", "objects", "method", "points", "hulls", "success", "claimed", "meshes touch")
    print("| " + " | ".join((*columns, "median", "p95")) + " |")
    print("| --- | ---: | --- | --- | --- | ---: | ---: | ---: | ---: | ---: |")
    for name in options.robots:
        for n_objects in options.objects:
            run(
                name,
                n_objects,
                options.scenarios,
                options.ycb,
                options.methods,
                clouds or [(BARE, LEAF)],
            )


if __name__ == "__main__":
    main()
