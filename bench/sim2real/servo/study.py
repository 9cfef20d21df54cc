"""Studies of a real servo that swings a known load, at two gains of its firmware."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import yaml

BESIDE = Path(__file__).resolve().parents[4] / "shared"
FOLDER = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings" / "bam_xl330"
MOTIONS = ("lift_and_drop", "sin_sin", "sin_time_square", "up_and_down")
GAINS = (100, 400)
MASS, LENGTH = 0.49, 0.1  # true [kg], [m]
UNIT = 4096 / (2 * np.pi) / 256 / 1000  # duty per rad and unit of gain, by the servo's manual
LIMIT = 0.885  # of the duty, in the servo's settings

URDF = """<robot name="servo"><link name="base"/><link name="arm"><inertial>
<origin xyz="0 0 {z}"/><mass value="{mass}"/>
<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint1" type="continuous"><parent link="base"/><child link="arm"/>
<axis xyz="0 1 0"/></joint></robot>
"""


def study(folder: Path, gain: int, mass: float = MASS, length: float = LENGTH, **keys: Any) -> Path:
    """A study of the four recordings at a gain."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "servo.urdf").write_text(URDF.format(z=-length, mass=mass))
    files = [{"file": str(FOLDER / f"kp{gain}_{name}.csv")} for name in MOTIONS]
    path = folder / "study.yaml"
    path.write_text(
        yaml.safe_dump({"robot": "servo.urdf", "joints": ["joint1"], "recordings": files, **keys})
    )
    return path
