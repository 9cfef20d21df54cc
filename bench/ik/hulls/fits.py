"""Occupancies of an arm with ever more hulls per link, fitted to its published meshes.

Finding them takes minutes per arm, so they are kept in a file: per link its covers by 1, 2, ...
hulls.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

import pdoik
from bench.common.whole_files import write_text
from bench.ik.experiment import Arm
from bench.ik.judges.arm_meshes import arm_meshes
from pdoik.occupancy_fit import cover_stages, tidy_point

MOST_PARTS = 10

# Of each link its covers, of each cover its hulls as [focus_a, focus_b, semi_major] [m].
Stages = dict[str, list[list[list[Any]]]]


def hull_stages(arm: Arm, folder: Path) -> Stages:
    """The covers of each link with geometry, from the folder's file or fitted now."""
    path = folder / f"{arm.name}.json"
    if not path.is_file():
        stages = {
            link: [
                [
                    [tidy_point(p.shape.focus_a), tidy_point(p.shape.focus_b), p.shape.semi_major]
                    for p in parts
                ]
                for parts in cover_stages(triangles, 1.0, MOST_PARTS)
            ]
            for link, triangles in arm_meshes(arm).items()
        }
        folder.mkdir(parents=True, exist_ok=True)
        write_text(path, json.dumps(stages, indent=1) + "\n")
    return json.loads(path.read_text())


def occupancy(stages: Stages, most: int) -> pdoik.Occupancy:
    """Hulls of all links, at most so many on each."""
    spheroids = [
        (link, a, link, b, semi_major)
        for link, covers in stages.items()
        for a, b, semi_major in max((c for c in covers if len(c) <= most), key=len)
    ]
    balls = [s for s in spheroids if np.allclose(s[1], s[3], atol=1e-9)]
    return pdoik.Occupancy(
        spheres=[(link, a, semi_major) for link, a, _, _, semi_major in balls],
        spheroids=[s for s in spheroids if s not in balls],
    )
