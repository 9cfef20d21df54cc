"""The study folder as a user would have it, and the truth in another folder."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from bench.common.whole_files import write_text
from bench.sim2real.frame.arm import Arm, Array

DIGITS = {"q": 7, "dq": 6, "tau": 5, "q_des": 7, "dq_des": 6, "tau_cmd": 5}
TIP = ("x", "y", "z", "qw", "qx", "qy", "qz")


def joint_names(arm: Arm) -> list[str]:
    return [f"joint{k + 1}" for k in range(arm.n)]


def write_recording(
    path: Path,
    channels: dict[str, Array],
    logged: list[str],
    tip: Array | None,
    rng: np.random.Generator,
) -> None:
    """One CSV; channels keep together, joints within each are in one shuffled order."""
    n = channels["q"].shape[1]
    order = rng.permutation(n)
    names, columns, formats = ["time"], [channels["time"]], ["%.5f"]
    for channel in rng.permutation(logged):
        for joint in order:
            names.append(f"{channel}.joint{joint + 1}")
            columns.append(channels[str(channel)][:, joint])
            formats.append(f"%.{DIGITS[str(channel)]}f")
    if tip is not None:
        for axis, column in zip(TIP, tip.T, strict=True):
            names.append(f"tip.{axis}")
            columns.append(column)
            formats.append("%.6f")
    row = ",".join(formats) + "\n"
    table = np.column_stack(columns)
    lines = [row % tuple(values) for values in table.tolist()]
    path.write_text(",".join(names) + "\n" + "".join(lines))


def write_study(folder: Path, urdf: str, study: dict[str, Any]) -> None:
    """Writes robot.urdf and study.yaml."""
    write_text(folder / "robot.urdf", urdf)
    text = yaml.safe_dump(study, sort_keys=False, default_flow_style=None, width=100)
    write_text(folder / "study.yaml", text)


def write_truth(folder: Path, study: Path, truth: dict[str, Any]) -> None:
    """Writes what is hidden in a study to a file of the study's name in another folder.

    Raises:
        ValueError: the folder lies in the study's own.
    """
    if folder.resolve().is_relative_to(study.resolve()):
        raise ValueError(f"truth: expected a folder outside of {study}, got {folder}")
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / f"{study.name}.json", json.dumps(truth, indent=1, sort_keys=True) + "\n")
