"""Joint-level logs as CSV."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from pdoik._files import write_whole
from pdoik.h1.robot import JOINT_NAMES
from pdoik.h1.simulate import Run

SIGNALS = ("q_des", "q", "dq", "tau")  # [rad], [rad], [rad/s], [N m]


def log_columns() -> list[str]:
    """The time [s], then each signal's 19 joints: q_des.left_ankle_joint, ..."""
    return ["time", *(f"{signal}.{joint}" for signal in SIGNALS for joint in JOINT_NAMES)]


def write_log(run: Run, path: str | Path, every: int = 1) -> None:
    """Write a run's rows, each or each so-manieth; the file appears whole or not at all."""
    rows = np.column_stack([run.time, *(getattr(run, signal) for signal in SIGNALS)])[::every]
    text = io.StringIO()
    np.savetxt(text, rows, "%.9g", delimiter=",", header=",".join(log_columns()), comments="")
    write_whole(path, text.getvalue())
