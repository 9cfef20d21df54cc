"""Pictures of the page "Goals: recipes", from what its own blocks compute.

    .venv/bin/python python/docs/goals_pictures.py [FOLDER]      python/docs/pictures without it

Each block of the page runs as it stands, and what it leaves is drawn.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from contextlib import chdir
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
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
    save,
)
from matplotlib.figure import Figure

import pdoik
from pdoik.picture.facets import FacetSoup

FloatArray = npt.NDArray[np.float64]

PAGE = Path(__file__).with_name("goals.md")
PICTURES = PAGE.parent / "pictures"
NEUTRAL, LINE = "#c9ced6", "#1f6fb4"


def values_of(page: Path) -> SimpleNamespace:
    """What the Python blocks of a page leave behind, run one after the other."""
    values: dict[str, object] = {}
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
    exec("\n".join(blocks), values)
    return SimpleNamespace(**values)


def draw(
    page: Path, drawn: dict[str, Callable[[SimpleNamespace], Figure]], arguments: list[str]
) -> None:
    """A page's pictures into the folder that comes first, all or those that are named after it."""
    folder = Path(arguments[0]).resolve() if arguments else PICTURES
    with TemporaryDirectory() as scratch, chdir(scratch):  # for files that the page writes
        values = values_of(page)
    for name in arguments[1:] or drawn:
        save(drawn[name](values), folder / f"{page.stem}_{name}.png")


def frame(soup: FacetSoup, T: FloatArray, length: float = 0.1) -> None:
    soup.frame(T, length, 0.03 * length)


def gripper(soup: FacetSoup, T_tip: FloatArray, T_tip_grip: FloatArray, color: str) -> None:
    """A fork, the usual sign of a grasp."""
    T = T_tip @ T_tip_grip

    def at(y: float, z: float) -> FloatArray:
        return np.asarray(T[:3, 3] + y * T[:3, 1] + z * T[:3, 2])

    for a, b in (((-0.045, 0.01), (-0.045, -0.05)), ((0.045, 0.01), (0.045, -0.05)),
                 ((-0.045, -0.05), (0.045, -0.05)), ((0, -0.05), (0, -0.1))):  # fmt: skip
        soup.capsule(at(*a), at(*b), 0.005, color, n=8)


def alone(scene: Scene3D, inches: float = 5.6, title: str = "") -> tuple[Figure, object]:
    figure, (axes,) = panels(1, 1, scene.camera, inches)
    scene.show(axes, title)
    return figure, axes


def tool(v: SimpleNamespace) -> Figure:
    scene = Scene3D(Camera(center=(0.28, 0.05, 0.38), width=1.25, azimuth=-62))
    add_robot(scene.solids, v.robot, v.welding.q)
    T = v.robot.fk(v.welding.q)
    tip = T @ v.torch
    bend = T[:3, 3] + 0.10 * T[:3, 2]
    scene.solids.capsule(T[:3, 3], bend, 0.016, TOOL)
    scene.solids.capsule(bend, tip[:3, 3] - 0.03 * tip[:3, 2], 0.011, TOOL)
    scene.solids.cone(tip[:3, 3] - 0.03 * tip[:3, 2], tip[:3, 3], (0.011, 0.002), TOOL)
    frame(scene.frames, v.seam)
    frame(scene.frames, T, 0.07)
    figure, axes = alone(scene)
    scene.label(axes, v.seam[:3, 3], "target, met by\nthe tip of the torch", (35, 50))
    scene.label(axes, T[:3, 3], "flange panda_link8", (60, -40))
    return figure


def grasps(v: SimpleNamespace) -> Figure:
    scene = Scene3D(Camera(center=(0.35, 0.0, 0.33), width=1.25, azimuth=-38, elevation=32))
    add_robot(scene.solids, v.robot, v.grasp.q)
    add_shape(scene.solids, v.body, SOLID)
    add_shape(scene.solids, v.wall, NEUTRAL)
    faint = scene.ghost(0.55)
    for k, each in enumerate(v.grasps):
        chosen = k == v.grasp.goal_index
        gripper(scene.frames if chosen else faint, each, np.eye(4), TOOL if chosen else FAINT)
    figure, axes = alone(scene)
    scene.label(axes, v.can + np.array([0, 0, 0.06]), "can", (50, -50))
    scene.label(axes, v.wall.T_base_shape[:3, 3] + [0, -0.05, 0.25], "wall", (-20, -40))
    chosen = v.grasps[v.grasp.goal_index]
    scene.label(axes, chosen[:3, 3] - 0.08 * chosen[:3, 2], f"grasp {v.grasp.goal_index}", (30, 70))
    return figure


def line(v: SimpleNamespace) -> Figure:
    scene = Scene3D(Camera(center=(0.3, 0.05, 0.35), width=1.45, azimuth=52, elevation=24))
    add_robot(scene.solids, v.robot, v.on_line.q)
    add_shape(scene.ghost(0.6), v.tank, SOLID)
    ends = [v.line[:3, 3] + side * 0.4 * v.line[:3, 1] for side in (-1, 1)]
    scene.frames.cone(*ends, (0.006, 0.006), GOAL)
    T = v.robot.fk(v.on_line.q)
    frame(scene.frames, T)
    figure, axes = alone(scene)
    scene.label(axes, T[:3, 3], "the flange, on the line", (60, 50))
    scene.label(axes, ends[0], "the line goes on through the tank", (-10, -70))
    return figure


def axis(v: SimpleNamespace) -> Figure:
    T = v.robot.fk(v.drilling.q)
    far = Scene3D(Camera(center=(0.25, -0.15, 0.4), width=1.2, azimuth=-62))
    near = Scene3D(
        Camera(center=(0.5, -0.3, 0.24), width=0.3, azimuth=-62, elevation=8), floor=None
    )
    length = 0.09
    for scene, robot in ((far, far.solids), (near, near.ghost(0.35))):
        add_robot(robot, v.robot, v.drilling.q)
        end, radius = v.hole[:3, 3] + length * v.hole[:3, 2], length * np.tan(v.tilt)
        scene.frames.cone(
            T[:3, 3] - 0.03 * T[:3, 2], T[:3, 3] + 1.2 * length * T[:3, 2], (0.001, 0.001), TOOL
        )
        scene.ghost(0.5).cone(v.hole[:3, 3], end, (0.0, radius), GOAL, n=40)
    figure, axes = panels(2, 2, far.camera, 4.2)
    far.show(axes[0])
    near.show(axes[1])
    near.label(axes[1], v.hole[:3, 3], "target position", (90, 40))
    near.label(axes[1], T[:3, 3] + 1.15 * length * T[:3, 2], "z axis of\nthe flange", (70, -20))
    near.label(axes[1], end, "5 degrees about\nthe target's axis", (-90, 10))
    return figure


def pick(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.28, 0.0, 0.36), width=1.35, azimuth=-28, elevation=26)
    figure, axes = panels(2, 2, camera, 4.2)
    for each, result, title in zip(axes, (v.pick, v.place), ("pick", "place"), strict=True):
        scene = Scene3D(camera)
        add_robot(scene.solids, v.robot, result.q)
        T = v.robot.fk(result.q)
        for part in (v.palm, *v.fingers):
            add_shape(scene.solids, part, "#6b7280", T)
        add_shape(scene.solids, v.fence, NEUTRAL)
        add_shape(scene.solids, v.cube.moved(T @ v.held), TOOL)
        scene.show(each, title)
    return figure


def hands(v: SimpleNamespace) -> Figure:
    q = v.both.q
    T = v.h1.fk(q, v.left)
    held = T.copy()
    held[:3, 3] = (T @ [0.3, -0.15, -0.015, 1])[:3]
    camera = Camera(center=(0.15, 0.0, 0.25), width=1.25, azimuth=30, elevation=16)
    figure, axes = panels(2, 2, camera, 4.2)
    for each, azimuth in zip(axes, (28, 88), strict=True):
        camera = replace(camera, azimuth=azimuth)
        scene = Scene3D(camera, floor=None)
        add_robot(scene.solids, v.h1, q)
        add_box(scene.ghost(0.7), (0.2, 0.3 - 0.066, 0.2), held, SOLID)
        add_box(scene.ghost(0.45), (0.1,) * 3, v.place_of_left, GOAL)
        scene.show(each)
        scene.label(each, v.place_of_left[:3, 3], "region of the left hand", (20, 110))
    return figure


def five(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.16, 0.1, 0.32), width=0.85, azimuth=-50)
    scene = Scene3D(camera)
    add_robot(scene.solids, v.arm, v.five.q)
    T = v.arm.fk(v.five.q)
    scene.frames.frame(T, 0.12, 0.004)
    faint = scene.ghost(0.45)
    faint.frame(v.tilted, 0.16, 0.004)
    figure, axes = alone(scene)
    scene.label(axes, v.tilted[:3, 3] + 0.14 * v.tilted[:3, 2], "z of the target", (60, 25))
    scene.label(axes, T[:3, 3] + 0.11 * T[:3, 2], "z of the tool", (-60, 25))
    return figure


def look(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.3, 0.1, 0.38), width=1.25, azimuth=38)
    figure, axes = panels(2, 2, camera, 4.2)
    titles = ("hard: it looks at the point", "soft: as nearly as 0.3 rad of tilt allows")
    for each, result, title in zip(axes, (v.seen, v.tries), titles, strict=True):
        scene = Scene3D(camera)
        add_robot(scene.solids, v.robot, result.q)
        T = v.robot.fk(result.q)
        scene.solids.balls(v.part[None], 0.025, np.array([[0.95, 0.55, 0.17]]), n=24)
        scene.solids.cone(T[:3, 3], T[:3, 3] + 0.05 * T[:3, 2], (0.02, 0.035), "#444a55")
        along = (v.part - T[:3, 3]) @ T[:3, 2]
        scene.frames.cone(T[:3, 3], T[:3, 3] + along * T[:3, 2], (0.003, 0.003), LINE)
        scene.show(each, title)
    return figure


def stand(camera: Camera) -> Scene3D:
    """A column that a UR10 stands on."""
    scene = Scene3D(camera, floor=-0.7)
    bottom, top = np.array([0.0, 0.0, -0.7]), np.array([0.0, 0.0, -0.01])
    scene.solids.cone(bottom, top, (0.08, 0.08), "#6b7280", n=40)
    return scene


def all_of_ur10(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.3, 0.1, 0.15), width=1.75, azimuth=-60, size=(380, 360))
    figure, axes = panels(8, 4, camera, 2.15)
    for k, (each, result) in enumerate(zip(axes, v.every, strict=True)):
        scene = stand(camera)
        add_robot(scene.solids, v.ur10, result.q)
        frame(scene.frames, v.T_ur, 0.18)
        scene.show(each, str(k))
    return figure


def clear(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.2, 0.0, 0.4), width=1.2, azimuth=-35, size=(380, 360), elevation=24)
    figure, axes = panels(12, 4, camera, 2.15)
    for k, (each, result) in enumerate(zip(axes, v.clear, strict=True)):
        scene = Scene3D(camera)
        add_robot(scene.solids, v.robot, result.q)
        add_shape(scene.solids, v.post, SOLID)
        frame(scene.frames, v.T_down, 0.12)
        scene.show(each, str(k))
    return figure


def nearest(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.15, 0.0, 0.4), width=2.5, azimuth=-60, size=(460, 420))
    figure, axes = panels(3, 3, camera, 2.9)
    configurations = (v.q_now, v.first.q, v.nearest.q)
    titles = ("now", f"first: {v.moved[0]:.2f} rad", f"nearest: {v.moved[1]:.2f} rad")
    for each, q, title in zip(axes, configurations, titles, strict=True):
        scene = stand(camera)
        add_robot(scene.solids, v.ur10, q)
        frame(scene.frames, v.T_ur, 0.2)
        scene.show(each, title)
    return figure


def lock(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.22, 0.0, 0.36), width=1.0, azimuth=-30, size=(460, 420), elevation=24)
    figure, axes = panels(3, 3, camera, 2.9)
    for each, elbow in zip(axes, (-0.8, 0.0, 0.8), strict=True):
        result = v.solver.solve(v.T_down, q0=v.ready, lock={"panda_joint3": elbow})
        scene = Scene3D(camera)
        add_robot(scene.solids, v.robot, result.q)
        frame(scene.frames, v.T_down)
        scene.show(each, f"panda_joint3 at {elbow} rad")
    return figure


def mass(v: SimpleNamespace) -> Figure:
    camera = Camera(center=(0.1, -0.2, 0.78), width=2.1, azimuth=-68, elevation=10, size=(520, 500))
    figure, axes = panels(2, 2, camera, 4.2)
    floor = -0.07
    for each, q, title in zip(axes, (v.stance, v.balanced.q), ("before", "reaching"), strict=True):
        scene = Scene3D(camera, floor=floor)
        add_robot(scene.ghost(0.75), v.stander, q)
        at = v.stander.center_of_mass(q)
        below = np.array([at[0], at[1], floor])
        scene.frames.balls(at[None], 0.04, np.array([[0.83, 0.15, 0.16]]), n=24)
        scene.frames.cone(at, below, (0.005, 0.005), "#d62728")
        T = np.eye(4)
        T[:3, 3] = 0.03, -0.2, floor + 0.004
        add_box(scene.ghost(0.6), (0.06, 0.5, 0.004), T, GOAL)
        scene.frames.balls(v.reach[None], 0.03, np.array([[0.95, 0.55, 0.17]]), n=24)
        scene.show(each, title)
        scene.label(each, at, "centre of mass", (-60, -30))
        scene.label(each, v.reach, "target of the elbow", (20, -45))
    return figure


def derivatives(v: SimpleNamespace) -> Figure:
    """Along x until the arm is straight."""
    places, distances, motions, q = np.linspace(0.45, 0.86, 150), [], [], v.ready
    kept = []
    for x in places:
        result = v.solver.solve(v.pose([x, 0.1, 0.2]), q0=q, derivatives=True)
        if not result.success:
            break
        q = result.q
        kept.append(x)
        distances.append(result.singular_distance)
        motions.append(1e-3 * np.linalg.norm(result.dq_dT[:, 0]))
    figure = Figure(figsize=(8.4, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(kept, distances, color=LINE)
    left.set(xlabel="x of the target [m]", ylabel="singular_distance [m]", ylim=(0, None))
    right.plot(kept, 1e3 * np.array(motions), color=TOOL)
    right.set(xlabel="x of the target [m]", ylabel="joint motion [mrad/mm]", yscale="log")
    right.set_yticks([5, 10, 20, 50], ["5", "10", "20", "50"])
    right.minorticks_off()
    for each in (left, right):
        each.grid(color="#e3e6ea")
        each.spines[["top", "right"]].set_visible(False)
    return figure


def success(v: SimpleNamespace) -> Figure:
    rng = np.random.default_rng(0)
    targets = [v.robot.fk(rng.uniform(v.robot.lower, v.robot.upper)) for _ in range(300)]
    figure = Figure(figsize=(8.4, 2.9), layout="constrained")
    axes = figure.subplots()
    bins = np.logspace(-15, -2, 53)
    for tolerance, color in ((1e-3, FAINT), (1e-5, LINE), (1e-8, TOOL)):
        options = pdoik.Options(
            max_time=0.2,
            self_collision=False,
            position_tolerance=tolerance,
            rotation_tolerance=tolerance,
        )
        batch = pdoik.Solver(v.robot, options).solve_batch(np.array(targets), threads=1)
        solved = batch.position_error[batch.success]
        label = f"tolerance {tolerance:.0e}: {len(solved)} of {len(targets)} solved"
        axes.hist(solved, bins, color=color, alpha=0.65, label=label)
        axes.axvline(tolerance, color=color, ls="--", lw=1.2)
    axes.set(xscale="log", xlabel="position error of a success [m]", ylabel="solves")
    axes.legend(frameon=False, fontsize=9, loc="upper left")
    axes.spines[["top", "right"]].set_visible(False)
    return figure


DRAWN: dict[str, Callable[[SimpleNamespace], Figure]] = {
    "tool": tool,
    "grasps": grasps,
    "line": line,
    "axis": axis,
    "pick": pick,
    "hands": hands,
    "five": five,
    "look": look,
    "all": all_of_ur10,
    "clear": clear,
    "nearest": nearest,
    "lock": lock,
    "mass": mass,
    "derivatives": derivatives,
    "success": success,
}


if __name__ == "__main__":
    draw(PAGE, DRAWN, sys.argv[1:])
