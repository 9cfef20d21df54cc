"""Pictures of the page "Paths and moves: recipes", from what its own blocks compute.

    .venv/bin/python python/docs/paths_pictures.py [FOLDER] [NAME ...]

Each block of the page runs as it stands, and what it leaves is drawn into python/docs/pictures, or
the folder that is given.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import numpy.typing as npt
from drawn_scenes import (
    FAINT,
    GOAL,
    SOLID,
    TOOL,
    Camera,
    Scene3D,
    add_box,
    add_robot,
    add_shape,
    panels,
)
from goals_pictures import LINE, NEUTRAL, draw
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import pdoik
from pdoik.picture.facets import FacetSoup

FloatArray = npt.NDArray[np.float64]

PAGE = Path(__file__).with_name("paths.md")
STOP = "#d3151b"
WAY = 0.004  # half the width of a drawn way [m]


def way(soup: FacetSoup, places: FloatArray, color: str, radius: float = WAY) -> None:
    for a, b in pairwise(places):
        if np.linalg.norm(b - a) > 1e-6:
            soup.capsule(a, b, radius, color, n=8)


def places_of(robot: pdoik.Robot, q: FloatArray, T_tip_tool: FloatArray) -> FloatArray:
    """Where the tool is, (m, 3), between corners too."""
    fine = [q[:1]]
    for a, b in pairwise(q):
        steps = max(1, int(np.ceil(np.abs(b - a).max() / 0.03)))
        fine.append(a + (b - a) * (np.arange(1, steps + 1) / steps)[:, None])
    return np.array([(robot.fk(each, robot.tip_links[0]) @ T_tip_tool)[:3, 3]
                     for each in np.concatenate(fine)])  # fmt: skip


def welder(v: SimpleNamespace, soup: FacetSoup, q: FloatArray) -> None:
    """The arm and its torch."""
    add_robot(soup, v.robot, q)
    T = v.robot.fk(q)
    for part in v.tube:
        add_shape(soup, part, TOOL, T)
    tip = T @ v.torch
    soup.cone(tip[:3, 3] - 0.015 * tip[:3, 2], tip[:3, 3], (0.007, 0.001), "#444a55")


def seam(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.33, 0.0, 0.4), width=1.15, azimuth=38, elevation=30, size=(460, 430))
    figure, axes = panels(3, 3, camera, 2.9)
    beside = int(np.argmin(np.abs(v.weld.at - 35.0)))
    for each, row in zip(axes, (0, beside, len(v.weld.q) - 1), strict=True):
        scene = Scene3D(camera)
        welder(v, scene.solids, v.weld.q[row])
        add_shape(scene.solids, v.work, SOLID)
        add_shape(scene.solids, v.clamp, "#7d8794")
        way(scene.frames, v.stations[:, :3, 3], GOAL)
        scene.show(each, f"station {v.weld.at[row]:.0f}")
        if row == 0:
            scene.label(each, v.stations[-12, :3, 3], "seam", (40, -40))
            scene.label(each, v.clamp.T_base_shape[:3, 3] + [0, 0, 0.1], "clamp", (60, -30))
    return figure


def closed(v: SimpleNamespace) -> Figure:
    figure = Figure(figsize=(8.4, 3.0), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    colors = ["#1f6fb4", "#f28e2b", "#1b7f3b", "#d3151b", "#7b5ea7", "#8c6d4f", "#4aa3a2"]
    for each, q, title in zip(axes, (np.array(v.chained), v.rounds),
                              ("each pose from the answer before", "closed=True"),
                              strict=True):  # fmt: skip
        for joint, color in enumerate(colors):
            label = f"joint {joint + 1}" if each is axes[0] else None
            each.plot(np.arange(len(q)) / 100, q[:, joint], color=color, lw=1.0, label=label)
        each.set_title(title, fontsize=10, color="#333333")
        each.set(xlabel="rounds", xlim=(0, 20), xticks=range(0, 21, 5))
    axes[0].set_ylabel("joints [rad]")
    figure.legend(frameon=False, fontsize=8, ncols=7, loc="outside lower center")
    return plain(figure, axes)


def breaks(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.25, 0.0, 0.45), width=1.4, azimuth=42, elevation=28)
    figure, axes = panels(2, 2, camera, 4.2)
    scene = Scene3D(camera)
    welder(v, scene.solids, v.blocked.ends[0].q)
    add_shape(scene.solids, v.work, SOLID)
    add_shape(scene.solids, v.post, "#7d8794")
    places = v.stations[:, :3, 3]
    bad = np.array(v.blocked.unsolved)
    way(scene.frames, places[: bad[0]], GOAL)
    way(scene.frames, places[bad[-1] + 1 :], FAINT)
    scene.show(axes[0], "not found; in red: no solution")
    scene.line(axes[0], places[bad], color=STOP, lw=0, marker=".", ms=5)
    end = v.blocked.ends[0]
    told = f"ends at station {end.at:.0f}:\n{end.reason}".replace(" to ", "\nto ")
    scene.label(axes[0], places[int(end.at)], told, (30, -290))

    scene = Scene3D(camera)
    (_, end), (start, _) = v.parts.pieces[:2]
    welder(v, scene.solids, v.parts.q[end - 1])
    welder(v, scene.ghost(0.35), v.parts.q[start])
    add_shape(scene.solids, v.work, SOLID)
    add_shape(scene.solids, v.tall, "#7d8794")
    for (a, b), color in zip(v.parts.pieces, (GOAL, LINE, "#7b5ea7", FAINT), strict=False):
        way(scene.frames, places_of(v.robot, v.parts.q[a:b], v.torch), color)
    way(scene.frames, places_of(v.robot, v.parts.moves[0], v.torch), TOOL, 0.6 * WAY)
    scene.show(axes[1], f"{len(v.parts.pieces)} pieces, and the first move")
    return figure


def hands(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.18, 0.0, 0.22), width=1.2, azimuth=38, elevation=14, size=(460, 430))
    figure, axes = panels(3, 3, camera, 2.9)
    rows = [0, len(v.lifted.q) // 2, len(v.lifted.q) - 1]
    for each, row in zip(axes, rows, strict=True):
        q = v.lifted.q[row]
        T = v.h1.fk(q, v.left)
        box = T.copy()
        box[:3, 3] = (T @ [0.3, -0.15, -0.015, 1])[:3]
        scene = Scene3D(camera, floor=None)
        add_robot(scene.solids, v.h1, q)
        add_box(scene.solids, (0.2, 0.3 - 0.066, 0.2), box, SOLID)
        hand = np.array([(v.h1.fk(each, v.left) @ v.hand)[:3, 3] for each in v.lifted.q])
        way(scene.frames, hand, GOAL)
        scene.show(each, f"station {v.lifted.at[row]:.0f}")
    return figure


def costs(v: SimpleNamespace) -> Figure:
    figure = Figure(figsize=(8.4, 2.8), layout="constrained")
    axes = figure.subplots()
    drawn = ((v.shortest, FAINT, "no costs"), (v.roomy, LINE, 'costs={"limits": 1.0}'))
    for path, color, label in drawn:
        label = f"{label}: {path.length:.2f} rad long"
        axes.plot(path.at, np.degrees(v.room(path)), color=color, label=label)
    axes.set(xlabel="station", xlim=(0, v.shortest.at[-1]), ylim=(0, None))
    axes.set_ylabel("least distance of a\njoint to its limit [deg]")
    axes.legend(frameon=False, fontsize=9)
    return plain(figure, [axes])


def timing(v: SimpleNamespace) -> Figure:
    figure = Figure(figsize=(8.4, 3.0), layout="constrained")
    axes = figure.subplots()
    drawn = ((v.fastest, FAINT, "time-optimal"), (v.steady, LINE, "0.1 m/s asked for"))
    for timed, color, label in drawn:
        t = np.linspace(0, timed.duration, 2001)
        q = timed.sample(t)[0]
        tip = np.array([(v.robot.fk(each) @ v.torch)[:3, 3] for each in q])
        speed = np.linalg.norm(np.diff(tip, axis=0), axis=1) / np.diff(t)
        label = f"{label}: {timed.duration:.2f} s"
        axes.plot((t[:-1] + t[1:]) / 2, speed, color=color, label=label)
    for dip in v.steady.dips[:3]:
        axes.annotate(dip.joint.removeprefix("panda_"), ((dip.start + dip.end) / 2, dip.speed),
                      (0, 34), textcoords="offset points", ha="center", fontsize=8,
                      color="#333333", arrowprops={"arrowstyle": "-", "lw": 0.5})  # fmt: skip
    axes.set(xlabel="time [s]", ylabel="speed of the torch's tip [m/s]", ylim=(0, None))
    axes.legend(frameon=False, fontsize=9)
    return plain(figure, [axes])


def pick(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.28, 0.0, 0.36), width=1.35, azimuth=-28, elevation=26)
    figure, axes = panels(2, 2, camera, 4.2)
    halves = (("to the cube, and down", (v.reach, v.pick)),
              ("up, over the fence, and down", (v.lift, v.over_fence, v.place)))  # fmt: skip
    for each, (title, motions) in zip(axes, halves, strict=True):
        scene = Scene3D(camera)
        holds = motions[0] is v.lift
        ends = (motions[0].q[0], motions[-1].q[-1])
        for soup, q in zip((scene.ghost(0.4), scene.solids), ends, strict=True):
            add_robot(soup, v.robot, q)
            T = v.robot.fk(q)
            for part in (v.palm, *v.fingers):
                add_shape(soup, part, "#6b7280", T)
            if holds:
                add_shape(soup, v.cube.moved(v.held), TOOL, T)
        if not holds:
            add_shape(scene.solids, v.cube, TOOL)
        add_shape(scene.solids, v.fence, NEUTRAL)
        for motion in motions:
            straight = hasattr(motion, "at")
            way(scene.frames, places_of(v.robot, motion.q, v.grip), GOAL if straight else LINE)
        scene.show(each, title)
    return figure


def dodge(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.42, 0.0, 0.36), width=0.95, azimuth=-8, elevation=8)
    figure = Figure(figsize=(8.4, 3.4), layout="constrained")
    left = figure.add_subplot(1, 2, 1)
    plots = [figure.add_subplot(3, 2, place) for place in (2, 4, 6)]
    nearest = int(np.argmax(v.offset))
    scene = Scene3D(camera)
    add_robot(scene.solids, v.robot, v.driven[nearest])
    (ball,) = v.ball_at(0.01 * nearest)
    add_shape(scene.ghost(0.6), ball, TOOL)
    way(scene.frames, places_of(v.robot, v.across.q, np.eye(4)), GOAL)
    way(scene.frames, places_of(v.robot, np.array(v.driven[::10]), np.eye(4)), LINE)
    scene.show(left, f"after {0.01 * nearest:.1f} s")
    scene.label(left, v.robot.fk(v.across.q[-8])[:3, 3], "planned, and back on it", (-10, 60))
    scene.label(left, v.robot.fk(v.driven[nearest])[:3, 3], "driven", (-60, 50))
    time = 0.01 * np.arange(1, len(v.offset) + 1)
    told = ((v.elapsed, "place on\nthe path [s]"), (100 * v.offset, "offset\n[cm]"),
            (100 * v.clearance, "clearance\n[cm]"))  # fmt: skip
    for each, (values, label) in zip(plots, told, strict=True):
        each.plot(time, values, color=LINE)
        each.set(xlim=(0, time[-1]), ylim=(0, None))
        each.set_ylabel(label, fontsize=8)
        each.tick_params(labelsize=8, labelbottom=each is plots[-1])
    plots[-1].axhline(1.0, color=STOP, lw=0.8, ls="--")
    plots[-1].set_xlabel("time [s]", fontsize=8)
    return plain(figure, plots)


def plain(figure: Figure, axes: Sequence[Axes]) -> Figure:
    for each in axes:
        each.grid(color="#e3e6ea")
        each.spines[["top", "right"]].set_visible(False)
    return figure


DRAWN: dict[str, Callable[[SimpleNamespace], Figure]] = {
    "seam": seam,
    "closed": closed,
    "breaks": breaks,
    "hands": hands,
    "costs": costs,
    "timing": timing,
    "pick": pick,
    "dodge": dodge,
}


if __name__ == "__main__":
    draw(PAGE, DRAWN, sys.argv[1:])
