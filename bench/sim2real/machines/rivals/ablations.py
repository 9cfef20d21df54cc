"""Our diagnosis with single stages switched off, by their thresholds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pdoik.sim2real import diagnose
from pdoik.sim2real.thresholds import Thresholds

OFF: dict[str, tuple[str, float]] = {
    "no first search beside the background": ("background.peculiar", 1e9),
    "what looks peculiar not held against the background": ("background.stands_t", -1e9),
    "joints' friction not weighed as sets": ("search.better_set", 1e9),
    "left-out sessions not asked": ("confidence.suspected", 0.0),
    "the torque's scale not in the intervals": ("figures.torque_scale", 0.0),
}
"""What is switched off: by which threshold, and what it is set to."""


def diagnosed(study: Path, changed: dict[str, float]) -> dict[str, Any]:
    """The diagnosis as its file would have it, with other thresholds."""
    return dict(json.loads(diagnose(study, thresholds=Thresholds().changed(changed)).to_json()))
