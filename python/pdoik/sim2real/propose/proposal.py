"""A proposed motion with what it is expected to settle, and its files."""

from __future__ import annotations

import io
import json
from dataclasses import asdict, dataclass
from pathlib import Path as File
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from pdoik._files import write_whole
from pdoik.recordings import FloatArray

from .clear import Verdict
from .expected import Pair, Prospect
from .figures import Figure

SCHEMA = "pdoik.proposal/1"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Proposal:
    """A motion that separates what a diagnosis could not, from rest to rest.

    Arrays are (T, n) in the order of `joints`.
    """

    joints: tuple[str, ...]
    time: FloatArray  # (T,) [s]
    q: FloatArray  # [rad], [m]
    dq: FloatArray
    torque: FloatArray  # that it is expected to need [N m], at the search's own steps
    used: dict[str, float]  # largest share of the limits of position, speed, acceleration, torque
    prospects: tuple[Prospect, ...]
    figures: tuple[Figure, ...]  # of all joints, where these were asked for
    unsettled: tuple[str, ...]  # what no motion settles, in words
    hopeless: frozenset[Pair]  # findings and the rivals listed with them, alike in every motion
    verdict: Verdict | None  # of obstacles and the robot itself; None: only limits were kept
    looked_at: int  # motions that were compared
    random: bool  # one motion at random, to compare with
    notes: tuple[str, ...] = ()

    @property
    def confidence(self) -> float:
        """Expected after it, of the finding that will be least sure."""
        return min((each.confidence for each in self.prospects), default=1.0)

    def at(self, times: FloatArray) -> FloatArray:
        """Positions at other times, (T, n): the curve through the rows."""
        curve = CubicHermiteSpline(self.time, self.q, self.dq)
        return np.asarray(curve(np.clip(times, 0.0, self.time[-1])), dtype=np.float64)

    def to_json(self) -> str:
        """What is known of the motion, without its rows."""
        content: dict[str, Any] = {
            "schema": SCHEMA,
            "joints": list(self.joints),
            "seconds": float(self.time[-1]),
            "start": self.q[0].tolist(),
            "random": self.random,
            "looked_at": self.looked_at,
            "used": self.used,
            "clear": None if self.verdict is None else _finite(asdict(self.verdict)),
            "expected": [_finite(asdict(each)) for each in self.prospects],
            "figures": [asdict(each) for each in self.figures],
            "unsettled": list(self.unsettled),
            "hopeless": sorted(map(list, self.hopeless)),
            "notes": list(self.notes),
        }
        return json.dumps(content, indent=1) + "\n"

    def to_csv(self) -> str:
        """Rows of time, q_des and dq_des, as a recording's commands."""
        names = [f"{channel}.{joint}" for channel in ("q_des", "dq_des") for joint in self.joints]
        text = io.StringIO()
        np.savetxt(
            text,
            np.column_stack([self.time, self.q, self.dq]),
            fmt="%.9g",
            delimiter=",",
            header=",".join(["time", *names]),
            comments="",
        )
        return text.getvalue()

    def save(self, path: str | File) -> tuple[File, File]:
        """Write the CSV, and what is expected of it as JSON next to it; returns both paths."""
        file = File(path)
        expected = file.with_suffix(".json")
        write_whole(expected, self.to_json())
        write_whole(file, self.to_csv())
        return file, expected


def _finite(content: Any) -> Any:
    """JSON knows no infinity."""
    if isinstance(content, dict):
        return {key: _finite(each) for key, each in content.items()}
    if isinstance(content, list | tuple):
        return [_finite(each) for each in content]
    if isinstance(content, float) and not np.isfinite(content):
        return None
    return content
