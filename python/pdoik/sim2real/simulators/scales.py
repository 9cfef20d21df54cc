"""Typical sizes of what joints do in some recordings, and the noise of what sensors show."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from .candidates import Values, model_with
from .experiment import Experiment
from .vocabulary import PROPERTIES

_FINEST = {"q": 1e-5, "tau": 1e-3}
"""What no sensor shows [rad], [N m]: noise of logs that have none, those of simulators."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scales:
    """Typical sizes at one joint under the recorded commands, which units are made of."""

    torque: float  # root mean square of the drive's [N m]
    speed: float  # [rad/s]
    acceleration: float  # [rad/s^2]
    travel: float  # of the position about its mean [rad]


def scales_of(experiment: Experiment, values: Values) -> tuple[Scales, ...]:
    """Typical sizes at each joint, of the recordings' motion and a candidate's gains."""
    model = model_with(experiment.user, values)
    user = replace(experiment.user, model=model)
    found = []
    for k in range(len(user.joints)):
        errors, speeds, accelerations, travels = [], [], [], []
        for each in experiment.recordings:
            assert each.q_des is not None
            q = each.q[:, k]
            smooth = np.convolve(q, np.ones(5) / 5.0, mode="valid")
            speed = np.gradient(smooth, each.period)
            errors.append(_rms(each.q_des[:, k] - q))
            speeds.append(_rms(speed))
            accelerations.append(_rms(np.gradient(speed, each.period)))
            travels.append(float(np.std(q)))
        gain = abs(PROPERTIES["kp"].read(user, k))
        found.append(
            Scales(
                torque=max(gain * max(errors), 1e-4 * gain, 1e-6),
                speed=max(*speeds, 1e-2),
                acceleration=max(*accelerations, 1e-1),
                travel=max(*travels, 1e-2),
            )
        )
    return tuple(found)


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


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
