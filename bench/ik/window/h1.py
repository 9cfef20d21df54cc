"""The picture of `pdoik view h1` in the README: the page as headless Chromium shows it.

python -m bench.ik.window.h1 bench/ik/window/view_h1.png

The H1 stands on its feet; its left elbow is dragged at 60 poses a second while the page is open.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import typer

import pdoik
from bench.ik.window.page import FloatArray, drag, opened, save, served
from pdoik.view import Session
from pdoik.view.humanoid import balance_over_feet
from pdoik.view.model import shipped_model

BASE, FOOT, ELBOW = "left_ankle_link", "right_ankle_link", "left_elbow_link"
WAY = [0.30, 0.18, 0.17]  # of the elbow [m]


def main(out: Path) -> None:
    robot = pdoik.Robot.builtin("h1", BASE, [FOOT, ELBOW])
    options = pdoik.Options(max_time=0.02, self_collision=True, balance=balance_over_feet())
    session = Session(robot, options)
    with served(shipped_model(robot), session) as viewer, opened(viewer, height=900) as page:
        page.wait_for_timeout(4000)
        drag(viewer, ELBOW, way(session.targets[ELBOW]))
        page.wait_for_timeout(12000)  # software rendering trails behind
        save(page.screenshot(), out)


def way(start: FloatArray) -> Iterator[FloatArray]:
    """Of the elbow, from its pose at the start."""
    for share in np.linspace(0, 1, 180):
        T = start.copy()
        T[:3, 3] += share * np.array(WAY)
        yield T


if __name__ == "__main__":
    typer.run(main)
