"""A sheet of pictures: one problem of each family with its defining configuration."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt

from bench.ik.problems.families import FAMILIES
from bench.ik.problems.judge import Judge
from bench.ik.problems.make import problems_of
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import robot_files

mpl.use("agg")
import matplotlib.pyplot as plt
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

FloatArray = npt.NDArray[np.float64]
AMONG = 20  # problems that the drawn one is the first solvable of
COLUMNS = 4
MANY = 20_000  # triangles: a link without a collision mesh is drawn by its visual one up to here
RED = (0.85, 0.25, 0.2)
LIGHT = np.array([0.4, -0.6, 0.7])


class _Judges(dict[str, tuple[Judge, Judge]]):
    """By coarse and by fine meshes, of each robot that is asked for."""

    def __missing__(self, robot: str) -> tuple[Judge, Judge]:
        files = robot_files(robot)
        self[robot] = Judge(files, "collision"), Judge(files, "visual")
        return self[robot]


def draw_sheet(path: Path, seed: int = 0) -> None:
    """Draw every family with its first robot.

    Args:
        path: The PNG.
        seed: Of the problems.
    """
    judges = _Judges()
    rows = -(-len(FAMILIES) // COLUMNS)
    figure = plt.figure(figsize=(3.2 * COLUMNS, 3.2 * rows), dpi=110)
    for k, family in enumerate(FAMILIES.values()):
        robot = next(iter(family.robots))
        problems = problems_of(family.name, robot, AMONG if family.contact else 1, seed)
        problem = next((p for p in problems if p.goal_q is not None), problems[0])
        axes = figure.add_subplot(rows, COLUMNS, k + 1, projection="3d")
        _draw(axes, problem, *judges[robot])
        axes.set_title(f"{family.name} ({robot})", fontsize=9)
    figure.subplots_adjust(0, 0, 1, 0.96, 0, 0.06)
    figure.savefig(path)
    plt.close(figure)


def draw_failures(path: Path, results: Sequence[Path], most: int = 8, seed: int = 0) -> int:
    """Draw problems that were not solved in their valid configurations, what was said to touch red.

    Args:
        path: The PNG.
        results: What `run` wrote, of our own families.
        most: Of each set one after the other, so many in all.
        seed: Of the problems.

    Returns:
        How many were drawn; without any there is no picture.
    """
    by_set: dict[str, dict[str, tuple[str, str]]] = {}
    for file in results:
        for row in json.loads(file.read_text())["rows"]:
            for trial in row["trials"]:
                if trial["known"] and not trial["claimed"]:
                    reason = f"{row['method']}, {row['budget']:g} ms: {trial['reason']}"
                    by_set.setdefault(row["set"], {})[trial["problem"]] = (row["robot"], reason)
    turns = [list(failed.items()) for failed in by_set.values()]
    chosen = [one[k] for k in range(most) for one in turns if k < len(one)][:most]
    if not chosen:
        return 0
    columns = min(COLUMNS, len(chosen))
    rows = -(-len(chosen) // columns)
    figure = plt.figure(figsize=(3.2 * columns, 3.6 * rows), dpi=110)
    judges = _Judges()
    for k, (name, (robot, reason)) in enumerate(chosen):
        family, _, index = name.rsplit("-", 2)
        problem = problems_of(family, robot, int(index) + 1, seed)[-1]
        axes = figure.add_subplot(rows, columns, k + 1, projection="3d")
        named = re.search(r"clearance of (\S+).* to (\S+)", reason)
        _draw(
            axes, problem, *judges[robot], red=frozenset(named.groups()) if named else frozenset()
        )
        axes.set_title("\n".join(textwrap.wrap(f"{name}: {reason}", 48)), fontsize=6)
    figure.subplots_adjust(0, 0, 1, 1 - 0.14 / rows, 0, 0.16)
    figure.savefig(path)
    plt.close(figure)
    return len(chosen)


def _draw(
    axes: Any, problem: Problem, coarse: Judge, fine: Judge, red: frozenset[str] = frozenset()
) -> None:
    axes.computed_zorder = False  # the robot shows through what is before it
    carriers = {solid for _, solid in problem.allowed}
    for solid in problem.solids:
        color = (0.85, 0.65, 0.3) if solid.name in carriers else (0.55, 0.6, 0.7)
        if solid.name in red:
            color = RED
        _add(axes, np.asarray(solid.surface().triangles), color, 0.28, 1)
    if problem.goal_q is not None:
        links = dict(coarse.link_surfaces(problem.goal_q))
        for name, triangles in fine.link_surfaces(problem.goal_q):
            if len(triangles) < MANY:
                links.setdefault(name, triangles)
        for name, triangles in links.items():
            _add(axes, triangles, RED if name in red else (0.92, 0.92, 0.9), 1.0, 2)
    for T in problem.targets.values():
        for axis, color in enumerate("rgb"):
            line = np.stack([T[:3, 3], T[:3, 3] + 0.12 * T[:3, axis]])
            axes.plot(*line.T, color=color, linewidth=1.5, zorder=3)
    middle = np.mean([T[:3, 3] for T in problem.targets.values()], axis=0) / 2 + [0, 0, 0.2]
    for setter, at in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, strict=True):
        setter(at - 0.7, at + 0.7)
    axes.set_box_aspect((1, 1, 1), zoom=1.45)
    ahead = np.degrees(np.arctan2(*next(iter(problem.targets.values()))[[1, 0], 3]))
    axes.view_init(elev=22, azim=ahead - 125)
    axes.set_axis_off()


def _add(
    axes: Any, triangles: FloatArray, color: tuple[float, ...], alpha: float, zorder: int
) -> None:
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    shade = 0.65 + 0.35 * np.abs(normals @ (LIGHT / np.linalg.norm(LIGHT)))
    colors = np.clip(shade[:, None] * np.array(color), 0, 1)
    faces = np.column_stack([colors, np.full(len(colors), alpha)])
    axes.add_collection3d(
        Poly3DCollection(triangles, facecolors=faces, linewidths=0, zorder=zorder)
    )
