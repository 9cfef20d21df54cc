"""The model that the user's simulator runs, as a study names it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorFile:
    """The model that the user's simulator runs."""

    path: Path
    format: str  # mjcf or urdf
    actuators: Mapping[str, str] = field(default_factory=dict)  # by joint, where given
