"""The pictures of `pdoik view` in the README and the pages, as headless Chromium shows the page.

    PDOIK_YCB=DIR python -m bench.ik.window arm FILE        (DIR/cloud/*.pcd; YCB, CC BY 4.0)
    PDOIK_YCB=DIR python -m bench.ik.window reach FILE
    python -m bench.ik.window h1 FILE
    python -m bench.ik.window example WIDE.png NARROW.png
    python -m bench.ik.window path FILE
    python -m bench.ik.window diagnosis REPORT FILE         (a folder that pdoik diagnose wrote)

Targets are dragged at 60 poses a second while the page is open.
"""

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
import typer

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import example_robot_data
from bench.ik.window.page import drag, opened, running, served, shoot
from pdoik.clouds import load_cloud
from pdoik.view import Session
from pdoik.view.diagnosis.report import load_report
from pdoik.view.diagnosis.viewer import DiagnosisViewer
from pdoik.view.drawing.shapes import pose_of
from pdoik.view.examples import EXAMPLES
from pdoik.view.humanoid import balance_over_feet
from pdoik.view.model import Model, shipped_model
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
BASE, FOOT, ELBOW = "left_ankle_link", "right_ankle_link", "left_elbow_link"

app = typer.Typer(help=__doc__, no_args_is_help=True, add_completion=False)


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


def way(start: FloatArray, shift: npt.ArrayLike, count: int) -> Iterator[FloatArray]:
    """Poses of a tip from its start, (4, 4) each, shifted ever more [m]."""
    for share in np.linspace(0, 1, count):
        T = start.copy()
        T[:3, 3] += share * np.asarray(shift)
        yield T


def panda_at_a_table() -> tuple[Model, Session]:
    """The shipped Panda as it looks, without the hand, which its hulls leave out; its tip above."""
    share = example_robot_data()
    urdf = share / "example-robot-data/robots/panda_description/urdf/panda.urdf"
    visuals, _ = load_visuals(urdf, [share])
    covered = {link: visuals[link] for link in (f"panda_link{i}" for i in range(8))}
    model = Model(robot=pdoik.Robot.builtin("panda"), visuals=covered)
    options = pdoik.Options(max_time=0.02, clearance=0.01, base_collision=False)
    session = Session(model.robot, options)
    session.set_thinning(0.02, True)
    session.set_cloud(scanned_table(Path(os.environ["PDOIK_YCB"])))
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = START
    session.set_target(TIP, T)
    return model, session


@app.command()
def arm(out: Path) -> None:
    """A Panda whose target goes down between objects on a table."""
    model, session = panda_at_a_table()
    with served(model, session) as viewer:
        viewer.obstacle_scene.ball.place(pose_of([1.0, 0.0, 0.0, 0.0], BALL))
        with opened(viewer) as page:
            page.get_by_label("Ball", exact=True).check(force=True)
            drag(viewer, TIP, way(session.targets[TIP], np.subtract(GOAL, START), 180))
            shoot(page, out)


@app.command()
def reach(out: Path) -> None:
    """What a Panda reaches around the table, as the page computes it, cut open next to the arm."""
    with served(*panda_at_a_table()) as viewer:
        viewer.solve_tab.hulls.value = False
        viewer.camera.go_to(np.array([0.31, 0.0, 0.42]), np.array([1.05, -2.3, 1.35]))  # [m]
        for target in viewer.targets.by_tip.values():
            target.show(False)
        tab = viewer.reach_tab
        tab.step.value = 50.0  # of the grid [mm]
        tab.map.at.value = 0.15  # y of the plane that cuts [m]
        tab.start()  # before there is a browser, which would take its time
        while tab.computing:
            time.sleep(0.5)
        with opened(viewer) as page:
            page.get_by_role("tab", name="Reach").click()
            shoot(page, out)


@app.command()
def h1(out: Path) -> None:
    """The H1 stands on its feet; its left elbow is dragged."""
    robot = pdoik.Robot.builtin("h1", BASE, [FOOT, ELBOW])
    options = pdoik.Options(max_time=0.02, self_collision=True, balance=balance_over_feet())
    session = Session(robot, options)
    with served(shipped_model(robot), session) as viewer, opened(viewer) as page:
        drag(viewer, ELBOW, way(session.targets[ELBOW], [0.30, 0.18, 0.17], 180))
        shoot(page, out)


@app.command()
def example(wide: Path, narrow: Path) -> None:
    """The first example on a wide window and on a narrow one: the hand goes next to the box."""
    for width, height, out in ((1440, 900, wide), (390, 844, narrow)):
        model, session = EXAMPLES[0].make()
        with (
            served(model, session, EXAMPLES[0]) as viewer,
            opened(viewer, width, height) as page,
        ):
            drag(viewer, TIP, way(session.targets[TIP], [0.03, 0.12, -0.16], 120))
            shoot(page, out)


@app.command()
def path(out: Path) -> None:
    """A scan along a block that breaks at a post, at the last station that is met."""
    session = Session(pdoik.Robot.builtin("panda"), pdoik.Options(max_time=0.02, clearance=0.003))
    block = pdoik.Shape.box("block", (0.3, 0.7, 0.2), _upright(0.55, 0.0, 0.1))
    post = pdoik.Shape.cylinder("post", 0.03, 0.4, _upright(0.55, 0.12, 0.4))
    session.set_shapes([block, post])
    corners = np.tile(np.diag([1.0, -1.0, -1.0, 1.0]), (2, 1, 1))
    corners[:, :3, 3] = [0.55, -0.32, 0.38], [0.55, 0.32, 0.38]
    scan = [pdoik.Goal(T, type="axis", axis="z") for T in pdoik.sample_path(corners, 0.01)]
    with served(shipped_model(session.robot), session) as viewer:
        for target in viewer.targets.by_tip.values():
            target.show(False)
        viewer.camera.go_to(np.array([0.55, 0.05, 0.3]), np.array([1.35, -1.1, 0.95]))  # [m]
        viewer.follow_path("scan.csv", scan)
        with opened(viewer) as page:
            page.get_by_role("tab", name="Replay").click()
            viewer.replay_tab.seek(viewer.replay_tab.time.max)
            page.wait_for_timeout(1000)
            shoot(page, out)


def _upright(x: float, y: float, z: float) -> FloatArray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


@app.command()
def diagnosis(
    report: Path, out: Path, package_dir: Annotated[list[Path] | None, typer.Option()] = None
) -> None:
    """The machine as recorded, and simulated before and after the findings, into a recording.

    The finding of most weight at one joint is opened. Meshes of package:// addresses are looked for
    in PACKAGE_DIR. A report is had by

        python -m bench.sim2real.example arm_study
        pdoik diagnose arm_study/study.yaml --out report
    """
    with running(
        lambda server: DiagnosisViewer(server, load_report(report), package_dir or ())
    ) as viewer:
        findings = viewer.report.diagnosis.findings
        viewer.findings.choose(next((f for f in findings if len(f.joints) == 1), findings[0]))
        viewer.times.value = "1"  # by which differences of positions are drawn larger
        elapsed = round(0.45 * viewer.timeline.duration, 2)
        viewer.player.seek(elapsed)
        viewer.time.value = elapsed
        with opened(viewer) as page:
            viewer.show(elapsed)
            shoot(page, out)


if __name__ == "__main__":
    app()
