"""The pictures of `pdoik view` without arguments, on a wide window and on a narrow one.

python bench/view_example_picture.py bench/view_example.png bench/view_narrow.png

The hand goes down beside the box of the first example at 60 poses a second.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pdoik.view.examples import EXAMPLES
from view_page import WIDTH, FloatArray, drag, opened, save, served

TIP = "panda_link8"
WAY = [0.03, 0.12, -0.16]  # of the hand [m]
WINDOWS = ((WIDTH, 850), (400, 800))  # width and height, pixels


def way(start: FloatArray) -> Iterator[FloatArray]:
    """Of the hand, from its pose at the start."""
    for share in np.linspace(0, 1, 120):
        T = start.copy()
        T[:3, 3] += share * np.array(WAY)
        yield T


def main(*outs: Path) -> None:
    for (width, height), out in zip(WINDOWS, outs, strict=False):
        model, session = EXAMPLES[0].make()
        with (
            served(model, session, EXAMPLES[0]) as viewer,
            opened(viewer, height, width) as page,
        ):
            drag(viewer, TIP, way(session.targets[TIP]))
            page.wait_for_timeout(8000)  # software rendering trails behind
            save(page.screenshot(timeout=120_000), out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
