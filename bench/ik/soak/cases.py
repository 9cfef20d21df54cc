"""What failed, as files that can be replayed; JSON keeps every digit."""

import base64
import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from bench.ik.soak.judge import Goals
from bench.ik.soak.robots import RobotSpec

KEPT = 20  # files of one job at most
SHORT = 64  # arrays with more numbers than this are kept as bytes


def encode(value: Any) -> Any:
    """Arrays as lists or as base64 of little-endian doubles."""
    match value:
        case np.ndarray() if 0 < value.size <= SHORT:
            return {"array": value.tolist()}
        case np.ndarray():
            raw = np.ascontiguousarray(value, dtype="<f8").tobytes()
            return {"float64": base64.b64encode(raw).decode(), "shape": list(value.shape)}
        case Goals():
            return {"goals": {f.name: encode(getattr(value, f.name)) for f in fields(value)}}
        case RobotSpec():
            return {"robot": asdict(value)}
        case dict():
            return {str(key): encode(item) for key, item in value.items()}
        case list() | tuple():
            return [encode(item) for item in value]
        case np.generic():
            return value.item()
    return value


def decode(value: Any) -> Any:
    """See `encode`."""
    if isinstance(value, list):
        return [decode(item) for item in value]
    if not isinstance(value, dict):
        return value
    match list(value):
        case ["array"]:
            return np.array(value["array"], dtype=np.float64)
        case ["float64", "shape"] | ["shape", "float64"]:
            raw = np.frombuffer(base64.b64decode(value["float64"]), dtype="<f8")
            return raw.reshape(value["shape"]).astype(np.float64)
        case ["robot"]:
            return RobotSpec.of_json(value["robot"])
        case ["goals"]:
            goals = {key: decode(item) for key, item in value["goals"].items()}
            tuples = ("axis", "position_slack", "rotation_slack")
            return Goals(**goals | {name: tuple(goals[name]) for name in tuples})
    return {key: decode(item) for key, item in value.items()}


def read_case(path: Path) -> dict[str, Any]:
    """A file of failures/, see `encode`."""
    return decode(json.loads(path.read_text()))
