"""White noise of what sensors show."""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from .experiment import Experiment

_FINEST = {"q": 1e-5, "tau": 1e-3}
"""What no sensor shows [rad], [N m]: noise of logs that have none, those of simulators."""


def noise_of(experiment: Experiment) -> FloatArray:
    """White noise of each channel, from third differences of neighbouring samples, (C,)."""
    found = []
    for channel, k in experiment.channels:
        squares = []
        for each in experiment.recordings:
            values = getattr(each, channel)[:, k]
            squares.append(float(np.median(np.diff(values, 3) ** 2)) / 0.455 / 20.0)
        found.append(max(np.sqrt(np.mean(squares)), _FINEST[channel]))
    return np.array(found)
