"""The study folder as a user would have it, and the truth in another folder."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.csv
import yaml

from bench.common.whole_files import write_text, write_whole
from bench.sim2real.legged.machine import FRICTION
from bench.sim2real.legged.robots import Robot
from bench.sim2real.legged.spec import Array

DIGITS = {"time": 5, "q": 7, "q_des": 7, "base": 7, "contact": 3}  # 6 of the others


def write_log(path: Path, table: dict[str, Array]) -> None:
    """One CSV."""
    columns = {
        name: np.round(values, DIGITS.get(name.partition(".")[0], 6)) + 0.0  # no -0
        for name, values in table.items()
    }
    text = pyarrow.BufferOutputStream()
    options = pyarrow.csv.WriteOptions(include_header=False, quoting_style="none")
    pyarrow.csv.write_csv(pyarrow.table(columns), text, write_options=options)
    head = (",".join(table) + "\n").encode()  # which pyarrow would quote
    write_whole(path, lambda new: new.write_bytes(head + text.getvalue().to_pybytes()))


def write_study(folder: Path, robot: Robot, recordings: list[dict[str, str]]) -> None:
    """robot.urdf and study.yaml."""
    shutil.copyfile(robot.urdf, folder / "robot.urdf")
    study = {
        "robot": "robot.urdf",
        "joints": list(robot.joints),
        "recordings": recordings,
        "controller": {
            "type": "pd",
            "kp": robot.kp.tolist(),
            "kd": robot.kd.tolist(),
            "gravity_compensation": False,
            "torque_limit": robot.effort.tolist(),
        },
        "rotor_inertia": robot.rotor.tolist(),
        "base": {
            "imu": {"position": list(robot.imu_position), "rpy": list(robot.imu_rpy)},
            "feet": {foot: {"sole": robot.sole} for foot in robot.feet},
            "ground": {"friction": FRICTION, "height": 0.0},
        },
    }
    text = yaml.safe_dump(study, sort_keys=False, default_flow_style=None, width=100)
    write_text(folder / "study.yaml", text)


def write_truth(path: Path, truth: dict[str, Any]) -> None:
    """The sealed answer."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps(truth, indent=1, sort_keys=True) + "\n")
