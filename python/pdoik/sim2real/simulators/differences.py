"""Machine and simulator channel by channel: how far apart, when most, and at which frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray, Recording

BANDS = ((0.0, 0.5), (0.5, 2.0), (2.0, 5.0), (5.0, 15.0), (15.0, np.inf))
"""Bands of frequency [Hz], in which the error's size is given."""

UNITS = {"q": "rad", "dq": "rad/s", "tau": "N m"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """How far apart both are in one channel of one joint in one recording."""

    recording: str
    joint: str
    channel: str
    unit: str
    rms: float
    largest: float
    when: float  # of the largest, on the recording's time [s]
    bands: tuple[float, ...]  # root mean square in each of `BANDS`


def differences_of(
    machine: Recording, shown: dict[str, FloatArray], joints: Sequence[str]
) -> tuple[Difference, ...]:
    """The differences in all channels that both have.

    Args:
        machine: the recording.
        shown: (T, n) by channel, what the simulator shows at its samples; NaN where nothing.
        joints: of the columns.
    """
    found = []
    for channel, values in shown.items():
        measured: FloatArray | None = getattr(machine, channel)
        if measured is None:
            continue
        for k, joint in enumerate(joints):
            error = measured[:, k] - values[:, k]
            there = machine.valid & np.isfinite(error)
            if there.sum() < 2:
                continue
            worst = int(np.nanargmax(np.where(there, np.abs(error), -1.0)))
            found.append(
                Difference(
                    recording=machine.name,
                    joint=joint,
                    channel=channel,
                    unit=UNITS[channel],
                    rms=float(np.sqrt(np.mean(error[there] ** 2))),
                    largest=float(abs(error[worst])),
                    when=float(machine.time[worst]),
                    bands=in_bands(error[there], machine.period),
                )
            )
    return tuple(found)


def in_bands(error: FloatArray, period: float) -> tuple[float, ...]:
    """Root mean square by frequency; their squares add up to that of the whole (Parseval)."""
    spectrum = np.abs(np.fft.rfft(error)) ** 2
    weight = np.full(len(spectrum), 2.0)
    weight[0] = 1.0
    if len(error) % 2 == 0:
        weight[-1] = 1.0
    power = weight * spectrum / len(error) ** 2
    frequency = np.fft.rfftfreq(len(error), period)
    return tuple(
        float(np.sqrt(power[(frequency >= low) & (frequency < high)].sum())) for low, high in BANDS
    )
