"""The picture of the Reach tab in the README: the page as headless Chromium shows it.

PDOIK_YCB=DIR python -m bench.ik.window.reach FILE     (as view_picture.py)

What a Panda reaches around a table with objects, as the page computes it, cut open beside the arm.
"""

import time
from pathlib import Path

import numpy as np
import typer

from bench.ik.window.arm import panda_model, table_session
from bench.ik.window.page import opened, save, served

STEP = 50.0  # of the grid [mm]
CUT = 0.15  # y of the plane [m]
LOOK_AT, CAMERA = np.array([0.31, 0.0, 0.42]), np.array([1.05, -2.3, 1.35])  # [m]


def main(out: Path) -> None:
    model = panda_model()
    with served(model, table_session(model.robot)) as viewer:
        viewer.solve_tab.hulls.value = False
        viewer.server.initial_camera.look_at = LOOK_AT
        viewer.server.initial_camera.position = CAMERA
        for target in viewer.targets.by_tip.values():
            target.show(False)
        tab = viewer.reach_tab
        tab.step.value = STEP
        tab.map.at.value = CUT
        tab.start()  # before there is a browser, which would take its time
        while tab.computing:
            time.sleep(0.5)
        with opened(viewer, height=930) as page:
            page.get_by_role("tab", name="Reach").click()
            page.wait_for_timeout(12000)  # software rendering trails behind
            save(page.screenshot(), out)


if __name__ == "__main__":
    typer.run(main)
