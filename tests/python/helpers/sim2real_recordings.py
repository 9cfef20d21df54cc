"""Recordings made in memory, for tests that need no file."""

from __future__ import annotations

import numpy as np

from pdoik.recordings import Recording, Role


def even_recording(
    time: np.ndarray,
    *,
    role: Role = "fit",
    start: float = 0.0,
    **channels: np.ndarray | None,
) -> Recording:
    """Of channels, (T, n) each, at even times from 0 [s], with nothing missing."""
    return Recording(
        name="rec.csv",
        role=role,
        start=start,
        time=time,
        valid=np.ones(len(time), dtype=bool),
        raw_period=float(time[1]),
        jitter=0.0,
        **channels,
    )
