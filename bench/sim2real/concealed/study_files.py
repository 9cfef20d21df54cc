"""The study folder as a user would have it, and the truth in another folder."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from bench.sim2real.concealed.arm import Arm, Array, urdf

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


def write_study(folder: Path, arm: Arm, study: dict[str, Any]) -> None:
    (folder / "robot.urdf").write_text(urdf(arm))
    text = yaml.safe_dump(study, sort_keys=False, default_flow_style=None, width=100)
    (folder / "study.yaml").write_text(text)


def write_truth(path: Path, truth: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(truth, indent=1, sort_keys=True) + "\n")
