"""The picture of `pdoik view h1` in the README: the page as headless Chromium shows it.

python bench/view_h1_picture.py bench/view_h1.png

The H1 stands on its feet; its left elbow is dragged at 60 poses a second while the page is open.
"""

from __future__ import annotations

import shutil
import sys
import time
from pathlib import Path

import numpy as np
from playwright.sync_api import Page, sync_playwright

import pdoik
from pdoik.view import Session
from pdoik.view.humanoid import balance_over_feet
from pdoik.view.model import shipped_model
from pdoik.view.server import start_server
from pdoik.view.viewer import Viewer
from view_picture import FLAGS, save

SIZE = {"width": 1400, "height": 900}
BASE, FOOT, ELBOW = "left_ankle_link", "right_ankle_link", "left_elbow_link"
WAY = [0.30, 0.18, 0.17]  # of the elbow [m]


def photograph(viewer: Viewer, page: Page) -> bytes:
    """Drag the elbow, then take the page, PNG."""
    page.goto(viewer.server.url)
    page.get_by_text("worst constraint").wait_for()
    page.locator(".mantine-Notification-closeButton").first.click()  # about software rendering
    page.wait_for_timeout(4000)
    start = viewer.session.targets[ELBOW]
    for share in np.linspace(0, 1, 180):
        T = start.copy()
        T[:3, 3] += share * np.array(WAY)
        viewer.targets.by_tip[ELBOW].place(T)
        viewer.session.set_target(ELBOW, T)
        viewer.worker.wake()
        time.sleep(1 / 60)
    page.wait_for_timeout(12000)  # software rendering trails behind
    return page.screenshot()


def main(out: Path) -> None:
    robot = pdoik.Robot.builtin("h1", BASE, [FOOT, ELBOW])
    options = pdoik.Options(max_time=0.02, self_collision=True, balance=balance_over_feet())
    server = start_server("127.0.0.1", 0)
    viewer = Viewer(server, shipped_model(robot), Session(robot, options))
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        png = photograph(viewer, browser.new_page(viewport=SIZE))
        browser.close()
    viewer.close()
    server.stop()
    save(png, out)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
