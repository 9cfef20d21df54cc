"""Numbers as people and as programs read them."""

from __future__ import annotations

import json
import math

import numpy as np


def limit_text(value: float, kind: str) -> str:
    """A joint's limit with its unit; turning joints in radians and degrees."""
    if not math.isfinite(value):
        return "none"
    if kind == "prismatic":
        return f"{value:.4f} m"
    return f"{value:.4f} rad ({math.degrees(value):.1f}°)"


def length_text(metres: float) -> str:
    """A length in a unit that suits it."""
    if not math.isfinite(metres):
        return "-"
    size = abs(metres)
    if size == 0:
        return "0 m"
    if size >= 1:
        return f"{metres:.3f} m"
    if size >= 1e-4:
        return f"{1e3 * metres:.2f} mm"
    return f"{1e6 * metres:.3g} µm" if size >= 1e-7 else f"{metres:.1e} m"


def angle_text(radians: float) -> str:
    """An angle in radians, and in degrees where those say something."""
    if not math.isfinite(radians):
        return "-"
    if abs(radians) < 1e-3:
        return f"{radians:.1e} rad"
    return f"{radians:.4f} rad ({math.degrees(radians):.2f}°)"


def time_text(seconds: float) -> str:
    """A duration in microseconds, milliseconds or seconds."""
    if not math.isfinite(seconds):
        return "-"
    if seconds < 1e-3:
        return f"{1e6 * seconds:.0f} µs"
    return f"{1e3 * seconds:.2f} ms" if seconds < 1 else f"{seconds:.2f} s"


def json_text(content: dict[str, object]) -> str:
    """A strict JSON object, a line for each entry: arrays as lists, what is not finite as null."""
    entries = (
        f"  {json.dumps(key)}: {json.dumps(_plain(value), allow_nan=False, ensure_ascii=False)}"
        for key, value in content.items()
    )
    return "{\n" + ",\n".join(entries) + "\n}"


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
