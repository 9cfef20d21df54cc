"""What the machine's computer writes: filtered, coarse, noisy, late, now and then stale."""

import numpy as np
from scipy.signal import lfilter

from bench.sim2real.machines.draw import Sensors
from bench.sim2real.machines.fault import Log
from bench.sim2real.machines.figures import Array
from bench.sim2real.machines.simulate import TICK, Track


def logged(
    track: Track,
    q_des: Array,
    dq_des: Array,
    sensors: Sensors,
    warm: float,
    rng: np.random.Generator,
) -> Log:
    """Channels at the rows of one recording.

    Args:
        track: what was true.
        q_des: (K, n) as sent.
        dq_des: (K, n) as sent.
        sensors: of the machine.
        warm: hours since the current sensors were set to zero.
        rng: of this recording.
    """
    ticks, n = track.rotor.shape
    speed = _smoothed(np.gradient(track.read, TICK, axis=0), sensors.speed_filter)
    torque = track.torque * (1.0 + sensors.current_gain)
    torque = torque + sensors.current_offset + warm * sensors.current_drift
    torque = _smoothed(torque, sensors.current_filter)
    rows = _rows(ticks, sensors, rng)
    count = len(rows)
    colour = _smoothed(
        rng.normal(size=(count, n)), 1.0 / (6.28 * sensors.colour_rate), sensors.period
    )
    colour *= sensors.coloured / np.maximum(np.std(colour, axis=0), 1e-12)
    torque = torque[rows] + colour + rng.normal(size=(count, n)) * sensors.white
    step = 2.0 * np.pi / 2.0**sensors.bits
    log = {
        "time": TICK * rows * (1.0 + sensors.clock),
        "q": np.rint(track.read[rows] / step) * step,
        "dq": speed[rows],
        "tau": np.rint(torque / sensors.torque_step) * sensors.torque_step,
        "q_des": q_des[rows].copy(),
        "dq_des": dq_des[rows].copy(),
    }
    for name in ("q", "dq", "tau"):  # the bus had nothing new
        old = rng.random((count, n)) < sensors.stale
        old[0] = False
        for j in range(n):
            source = np.maximum.accumulate(np.where(old[:, j], 0, np.arange(count)))
            log[name][:, j] = log[name][source, j]
    log["time"] = log["time"] + rng.uniform(-0.2, 0.2, count) * 1e-4
    return log


def _rows(ticks: int, sensors: Sensors, rng: np.random.Generator) -> Array:
    times = np.arange(0.0, TICK * (ticks - 2), sensors.period)
    times = times + rng.normal(0.0, max(sensors.jitter, 1e-9), len(times))
    rows = np.unique(np.clip(np.rint(times / TICK).astype(int), 0, ticks - 1))
    keep = rng.random(len(rows)) >= sensors.lost
    keep[0] = True
    return rows[keep]


def _smoothed(values: Array, time: float, period: float = TICK) -> Array:
    """A first-order filter that starts at rest."""
    share = period / (period + time)
    start = (1.0 - share) * values[:1]
    return np.asarray(lfilter([share], [1.0, share - 1.0], values, axis=0, zi=start)[0])


def channels(sensors: Sensors) -> list[str]:
    """Names of the channels that are written."""
    names = ["q", "tau"]
    names += ["dq"] if sensors.dq else []
    names += ["q_des"] if sensors.commands else []
    names += ["dq_des"] if sensors.commands and sensors.speeds else []
    return names
