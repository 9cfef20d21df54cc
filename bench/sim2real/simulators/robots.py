"""The robots whose simulators are wrong."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pdoik


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """A description, its gains and the posture about which it moves."""

    urdf: Path
    kp: tuple[float, ...]
    kv: tuple[float, ...]
    rest: tuple[float, ...]
    damping: tuple[float, ...]
    joints: int


def robots() -> dict[str, Robot]:
    """By name; the quadruped only where example-robot-data is installed."""
    found = {
        "panda": Robot(
            urdf=Path(pdoik.__file__).parent / "robots" / "panda.urdf",
            kp=(400.0, 400.0, 300.0, 300.0, 120.0, 120.0, 60.0),
            kv=(40.0, 40.0, 30.0, 30.0, 8.0, 8.0, 3.0),
            rest=(0.0, 0.3, 0.0, -1.8, 0.0, 2.0, 0.5),
            damping=(1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.3),
            joints=7,
        )
    }
    go2 = "cmeel.prefix/share/example-robot-data/robots/go2_description/urdf/go2.urdf"
    path = Path(np.__file__).parents[1] / go2
    if path.is_file():
        found["go2"] = Robot(
            urdf=path,
            kp=(20.0,) * 12,
            kv=(1.5,) * 12,
            rest=(0.0, 0.9, -1.6) * 4,
            damping=(0.1,) * 12,
            joints=12,
        )
    return found
