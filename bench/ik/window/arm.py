"""The picture of `pdoik view` in the README: the page as headless Chromium shows it.

PDOIK_YCB=DIR python -m bench.ik.window.arm FILE     (DIR/cloud/*.pcd; YCB, CC BY 4.0)

The target goes down between the objects at 60 poses a second while the page is open.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
import typer

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.judges.arm_meshes import example_robot_data
from bench.ik.window.page import drag, opened, save, served
from pdoik.clouds import load_cloud
from pdoik.view import Session
from pdoik.view.model import Model
from pdoik.view.shapes import pose_of
from pdoik.view.visuals import load_visuals

OBJECTS = {  # x, y [m] and turn about z [rad] on the table
    "003_cracker_box": (0.66, -0.24, 0.5),
    "006_mustard_bottle": (0.60, 0.21, 0.2),
    "021_bleach_cleanser": (0.80, 0.02, 1.0),
    "025_mug": (0.46, 0.32, 2.2),
    "002_master_chef_can": (0.45, -0.12, 0.0),
    "011_banana": (0.52, -0.33, 0.9),
}
TIP = "panda_link8"
BALL = [0.56, 0.0, 0.62]  # [m]
START, GOAL = [0.55, 0.03, 0.55], [0.56, 0.06, 0.095]  # of the tip, which points down [m]


def scanned_table(ycb: Path) -> FloatArray:
    """A table top with objects standing on it, (N, 3) [m]."""
    rng = np.random.default_rng(0)
    clouds = [rng.uniform([0.34, -0.40, 0.0], [0.90, 0.45, 0.0], (9000, 3))]
    for name, (x, y, turn) in OBJECTS.items():
        points = load_cloud(ycb / "cloud" / f"{name}.pcd")
        points = points - [*points.mean(axis=0)[:2], points[:, 2].min()]
        c, s = np.cos(turn), np.sin(turn)
        clouds.append(points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [x, y, 0.0])
    return np.concatenate(clouds)


def downward(xyz: npt.ArrayLike) -> FloatArray:
    """The tip at xyz with its z axis down, (4, 4)."""
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = xyz
    return T


def way() -> Iterator[FloatArray]:
    """Of the tip, from above the table down between the objects."""
    for t in np.linspace(0, 1, 180):
        yield downward((1 - t) * np.array(START) + t * np.array(GOAL))


def panda_model() -> Model:
    """The shipped Panda as it looks, without the hand, which its hulls leave out."""
    share = example_robot_data()
    urdf = share / "example-robot-data/robots/panda_description/urdf/panda.urdf"
    visuals, _ = load_visuals(urdf, [share])
    covered = {f"panda_link{i}" for i in range(8)}
    return Model(
        robot=pdoik.Robot.builtin("panda"),
        visuals={link: glb for link, glb in visuals.items() if link in covered},
    )


def table_session(robot: pdoik.Robot) -> Session:
    """The robot at the scanned table, its tip above it."""
    session = Session(robot, pdoik.Options(max_time=0.02, clearance=0.01, base_collision=False))
    session.set_thinning(0.02, True)
    session.set_cloud(scanned_table(Path(os.environ["PDOIK_YCB"])))
    session.set_target(TIP, downward(START))
    return session


def main(out: Path) -> None:
    model = panda_model()
    session = table_session(model.robot)
    with served(model, session) as viewer:
        viewer.obstacle_scene.ball.place(pose_of([1.0, 0.0, 0.0, 0.0], BALL))
        with opened(viewer, height=850) as page:
            page.get_by_label("Ball", exact=True).check(force=True)
            page.wait_for_timeout(4000)
            drag(viewer, TIP, way())
            page.wait_for_timeout(6000)  # software rendering trails behind
            save(page.screenshot(), out)


if __name__ == "__main__":
    typer.run(main)
