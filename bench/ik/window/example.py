"""The pictures of `pdoik view` without arguments, on a wide window and on a narrow one.

    python -m bench.ik.window.example WIDE.png NARROW.png

The hand goes down beside the box of the first example at 60 poses a second.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import typer

from bench.ik.window.page import WIDTH, FloatArray, drag, opened, save, served
from pdoik.view.examples import EXAMPLES

TIP = "panda_link8"
WAY = [0.03, 0.12, -0.16]  # of the hand [m]
WINDOWS = ((WIDTH, 850), (400, 800))  # width and height, pixels


def way(start: FloatArray) -> Iterator[FloatArray]:
    """Of the hand, from its pose at the start."""
    for share in np.linspace(0, 1, 120):
        T = start.copy()
        T[:3, 3] += share * np.array(WAY)
        yield T


def main(wide: Path, narrow: Path) -> None:
    """Take both pictures."""
    for (width, height), out in zip(WINDOWS, (wide, narrow), strict=True):
        model, session = EXAMPLES[0].make()
        with served(model, session, EXAMPLES[0]) as viewer, opened(viewer, height, width) as page:
            drag(viewer, TIP, way(session.targets[TIP]))
            page.wait_for_timeout(8000)  # software rendering trails behind
            save(page.screenshot(timeout=120_000), out)


if __name__ == "__main__":
    typer.run(main)
