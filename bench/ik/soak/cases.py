"""What failed, as files that can be replayed; JSON keeps every digit."""

import base64
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bench.ik.soak.judge import Goals
from bench.ik.soak.robots import FloatArray, RobotSpec

SHORT = 64  # arrays with more numbers than this are kept as bytes
KEPT = 20  # files of one job at most


def encode(value: Any) -> Any:
    """Arrays as lists or as base64 of little-endian doubles."""
    if isinstance(value, np.ndarray):
        if 0 < value.size <= SHORT:
            return {"array": value.tolist()}
        text = base64.b64encode(np.ascontiguousarray(value, dtype="<f8").tobytes()).decode()
        return {"float64": text, "shape": list(value.shape)}
    if isinstance(value, Goals):
        return {"goals": {key: encode(item) for key, item in asdict(value).items()}}
    if isinstance(value, RobotSpec):
        return {"robot": value.to_json()}
    if isinstance(value, dict):
        return {str(key): encode(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [encode(item) for item in value]
    if isinstance(value, np.generic):
        return value.item()
    return value


def decode(value: Any) -> Any:
    """See `encode`."""
    if isinstance(value, list):
        return [decode(item) for item in value]
    if not isinstance(value, dict):
        return value
    if value.keys() == {"array"}:
        return np.array(value["array"], dtype=np.float64)
    if value.keys() == {"float64", "shape"}:
        raw: FloatArray = np.frombuffer(base64.b64decode(value["float64"]), dtype="<f8")
        return raw.reshape(value["shape"]).astype(np.float64)
    if value.keys() == {"robot"}:
        return RobotSpec.of_json(value["robot"])
    if value.keys() == {"goals"}:
        goals = {key: decode(item) for key, item in value["goals"].items()}
        for name in ("axis", "position_slack", "rotation_slack"):
            goals[name] = tuple(goals[name])
        return Goals(**goals)
    return {key: decode(item) for key, item in value.items()}


def read_case(path: Path) -> dict[str, Any]:
    """A file of failures/, see `encode`."""
    case: dict[str, Any] = decode(json.loads(path.read_text()))
    return case
