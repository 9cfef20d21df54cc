"""A sheet of pictures: one problem of each family with its defining configuration."""

import json
import re
import textwrap
from collections.abc import Collection, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.pictures import cube, faces, plt, save
from bench.ik.problems.families import FAMILIES
from bench.ik.problems.judge import Judge
from bench.ik.problems.make import problems_of
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import robot_files

AMONG = 20  # problems that the drawn one is the first solvable of
COLUMNS = 4
MOST = 8  # failures that are drawn
MANY = 20_000  # triangles: a link without a collision mesh is drawn by its visual one up to here
RED = (0.85, 0.25, 0.2)
LIGHT = np.array([0.4, -0.6, 0.7])


@cache
def _judges(robot: str) -> tuple[Judge, Judge]:
    """Judges by coarse and by fine meshes."""
    return Judge(robot_files(robot), "collision"), Judge(robot_files(robot), "visual")


def draw_sheet(path: Path, seed: int = 0) -> None:
    """Draw every family with its first robot."""
    panels = []
    for family in FAMILIES.values():
        robot = next(iter(family.robots))
        problems = problems_of(family.name, robot, AMONG if family.contact else 1, seed)
        problem = next((p for p in problems if p.goal_q is not None), problems[0])
        panels.append((problem, robot, f"{family.name} ({robot})", ()))
    _sheet(path, panels, height=3.2, fontsize=9, edges=(0.96, 0.06))


def draw_failures(path: Path, results: Sequence[Path], seed: int = 0) -> int:
    """Draw problems that were not solved in their valid configurations, what was said to touch red.

    The results are what `run` wrote, of our own families: of each set one after the other. Says
    how many were drawn; without any there is no picture.
    """
    by_set: dict[str, dict[str, tuple[str, str]]] = {}
    for file in results:
        for row in json.loads(file.read_text())["rows"]:
            for trial in row["trials"]:
                if trial["known"] and not trial["claimed"]:
                    reason = f"{row['method']}, {row['budget']:g} ms: {trial['reason']}"
                    by_set.setdefault(row["set"], {})[trial["problem"]] = (row["robot"], reason)
    turns = [list(failed.items()) for failed in by_set.values()]
    chosen = [one[k] for k in range(MOST) for one in turns if k < len(one)][:MOST]
    panels = []
    for name, (robot, reason) in chosen:
        family, _, index = name.rsplit("-", 2)
        problem = problems_of(family, robot, int(index) + 1, seed)[-1]
        named = re.search(r"clearance of (\S+).* to (\S+)", reason)
        title = "\n".join(textwrap.wrap(f"{name}: {reason}", 48))
        panels.append((problem, robot, title, named.groups() if named else ()))
    if panels:
        top = 1 - 0.14 / -(-len(panels) // min(COLUMNS, len(panels)))
        _sheet(path, panels, height=3.6, fontsize=6, edges=(top, 0.16))
    return len(panels)


def _sheet(
    path: Path,
    panels: Sequence[tuple[Problem, str, str, Collection[str]]],
    height: float,
    fontsize: float,
    edges: tuple[float, float],
) -> None:
    """Problems of robots with titles and what is red."""
    columns = min(COLUMNS, len(panels))
    rows = -(-len(panels) // columns)
    figure = plt.figure(figsize=(3.2 * columns, height * rows), dpi=110)
    for k, (problem, robot, title, red) in enumerate(panels, start=1):
        axes = figure.add_subplot(rows, columns, k, projection="3d")
        _draw(axes, problem, *_judges(robot), red)
        axes.set_title(title, fontsize=fontsize)
    figure.subplots_adjust(0, 0, 1, edges[0], 0, edges[1])
    save(figure, path)


def _draw(axes: Any, problem: Problem, coarse: Judge, fine: Judge, red: Collection[str]) -> None:
    axes.computed_zorder = False  # the robot shows through what is before it
    carriers = {solid for _, solid in problem.allowed}
    for solid in problem.solids:
        color = (0.85, 0.65, 0.3) if solid.name in carriers else (0.55, 0.6, 0.7)
        color = RED if solid.name in red else color
        _add(axes, np.asarray(solid.surface().triangles), color, 0.28, 1)
    if problem.goal_q is not None:
        links = dict(coarse.link_surfaces(problem.goal_q))
        for name, triangles in fine.link_surfaces(problem.goal_q):
            if len(triangles) < MANY:
                links.setdefault(name, triangles)
        for name, triangles in links.items():
            _add(axes, triangles, RED if name in red else (0.92, 0.92, 0.9), 1.0, 2)
    targets = list(problem.targets.values())
    for T in targets:
        for axis, color in enumerate("rgb"):
            line = np.stack([T[:3, 3], T[:3, 3] + 0.12 * T[:3, axis]])
            axes.plot(*line.T, color=color, linewidth=1.5, zorder=3)
    cube(axes, np.mean([T[:3, 3] for T in targets], axis=0) / 2 + [0, 0, 0.2], 0.7, zoom=1.45)
    ahead = np.degrees(np.arctan2(*targets[0][[1, 0], 3]))
    axes.view_init(elev=22, azim=ahead - 125)
    axes.set_axis_off()


def _add(
    axes: Any, triangles: FloatArray, color: tuple[float, ...], alpha: float, zorder: int
) -> None:
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    shade = 0.65 + 0.35 * np.abs(normals @ (LIGHT / np.linalg.norm(LIGHT)))
    colors = np.clip(shade[:, None] * np.array(color), 0, 1)
    colors = np.column_stack([colors, np.full(len(colors), alpha)])
    faces(axes, triangles, facecolors=colors, linewidths=0, zorder=zorder)
