"""Draws some failures of an experiment's trials, to look for their causes.

    python -m bench.ik.success.failures build/bench/success --method pdoik --out failures.png

Each panel shows the arm's meshes where the method left them, the objects' meshes, the cloud that
the method saw, and the target's z axis, about where a link and an object meet, or the whole arm.
"""

import json
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer

from bench.common.arrays import FloatArray, moved
from bench.ik.experiment import ARMS
from bench.ik.judges.arm_meshes import arm_meshes
from bench.ik.pictures import cube, faces, plt, save
from bench.ik.scenes.around import arm_named, mesh_judge, models_of, random_scene_around
from bench.ik.success.trials import scenario_seed

# What is shown about the place [m], and what is said.
CAUSES = {
    "fails_collision": (0.22, "touches"),
    "fails_pose": (0.9, "misses the goal"),
    "fails_limits": (0.9, "limits"),
}


def main(
    folder: Annotated[Path, typer.Argument(help="Of a campaign of bench/ik/success/__main__.py.")],
    out: Annotated[Path, typer.Option(help="The picture.")] = Path("failures.png"),
    method: Annotated[list[str] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
    robot: Annotated[list[str] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
    cause: Annotated[str, typer.Option(help="fails_collision, fails_pose or fails_limits.")] = (
        "fails_collision"
    ),
    count: Annotated[int, typer.Option(min=1, max=6, help="Panels.")] = 3,
) -> None:
    """Draw failures."""
    settings = json.loads((folder / "settings.json").read_text())
    trials = pd.read_parquet(folder / "trials.parquet")
    some = trials[trials[cause] & trials.method.isin(method or trials.method)]
    some = some[some.robot.isin(robot or ARMS)]
    if some.empty:
        raise typer.BadParameter("no such failure")
    chosen = some.sample(min(count, len(some)), random_state=0)
    figure = plt.figure(figsize=(5.2 * len(chosen), 5.4))
    for k, (_, trial) in enumerate(chosen.iterrows(), start=1):
        _panel(figure.add_subplot(1, len(chosen), k, projection="3d"), trial, settings, cause)
    figure.tight_layout(rect=(0, 0, 1, 0.94))
    save(figure, out, dpi=90)
    print(chosen[["robot", "method", "n_objects", "index", "position_error", "collision"]])


def _panel(ax: Any, trial: pd.Series, settings: dict[str, Any], cause: str) -> None:
    arm, n_objects = arm_named(trial.robot), int(trial.n_objects)
    seed = scenario_seed(settings["seed"], trial.robot, n_objects, trial["index"])
    judge, models = mesh_judge(trial.robot), models_of(settings["ycb"])
    q_known, scene, bodies = random_scene_around(arm, judge, models, n_objects, seed)
    q, cloud = np.asarray(trial.q), scene.cloud(settings["leaf"])
    links = {link: moved(part, arm.robot.fk(q, link)) for link, part in arm_meshes(arm).items()}
    target = arm.robot.fk(q_known)
    half, said = CAUSES[cause]
    centre = arm.robot.fk(q)[:3, 3] if cause == "fails_collision" else np.array([0, 0, 0.5])
    hit, _, name = trial.collision.partition(" and ")
    if hit:
        touching = next(body for body in bodies if body.name == name)
        centre = _nearest(links[hit], touching.triangles)

    def show(triangles: FloatArray, colour: str, alpha: float) -> None:
        near = triangles[(np.abs(triangles.mean(axis=1) - centre) < 1.1 * half).all(axis=1)]
        if len(near):
            faces(ax, near, facecolor=colour, edgecolor="#00000018", lw=0.2, alpha=alpha)

    for link, triangles in links.items():
        show(triangles, *(("#d3151b", 1.0) if link == hit else ("#9aa3ad", 0.5)))
    for body in bodies:
        show(body.triangles, "#f0a030", 0.35)
    near = cloud[np.abs(cloud - centre).max(axis=1) < half]
    ax.scatter(*near.T, s=22, c="black", depthshade=False)
    ax.quiver(*target[:3, 3], *(0.15 * target[:3, 2]), color="#1f5fd0")
    cube(ax, centre, half)
    ax.tick_params(labelsize=7)
    what = trial.collision or f"{1e3 * trial.position_error:.0f} mm off"
    ax.set_title(f"{trial.method}, {trial.robot}: {said}\n{what}", fontsize=9)


def _nearest(a: FloatArray, b: FloatArray) -> FloatArray:
    """About where two meshes meet: the nearest pair of triangles' middles."""
    p, q = a.mean(axis=1), b.mean(axis=1)
    gaps = np.linalg.norm(p[:, None] - q[None], axis=2)
    return np.asarray(p[np.unravel_index(gaps.argmin(), gaps.shape)[0]])


if __name__ == "__main__":
    typer.run(main)
