"""How large an effect is beside the noise, and the amplitude that makes it so large."""

from __future__ import annotations

import numpy as np

from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.equipment import Sensors
from bench.sim2real.concealed.reference import Reference


def active_rows(effect: Effect, ref: Reference) -> Array:
    """Rows of the reference in the effect's window."""
    position = 0.0 if effect.joint is None else ref.q[:, effect.joint]
    weight = np.broadcast_to(effect.gate.weight(position, ref.time), ref.time.shape)
    rows = weight > 0.0
    if effect.gate.recordings is not None:
        rows &= np.isin(ref.recording, effect.gate.recordings)
    return rows & effect.acts(ref)


def noise_of(effect: Effect, sensors: Sensors) -> Array:
    """Standard deviations (n,) of the channel that shows the effect."""
    if effect.channel == "dq":
        return sensors.dq_noise
    if effect.channel == "q":
        return np.hypot(sensors.q_noise, sensors.q_step / np.sqrt(12.0))
    return sensors.tau_noise


def multiple(effect: Effect, ref: Reference, sensors: Sensors) -> float:
    """Root mean square of what the model misses where it acts, in the worst joint's noise."""
    rows = active_rows(effect, ref)
    if not rows.any():
        return 0.0
    rms = np.sqrt(np.mean(effect.residual(ref)[rows] ** 2, axis=0))
    result = float(np.max(rms / noise_of(effect, sensors)))
    shift = getattr(effect, "tip_shift", None)
    if sensors.tip and shift is not None:
        some = np.arange(0, len(ref.q), 10)
        tip = np.sqrt(np.mean(shift(ref, some) ** 2, axis=0))
        result = max(result, float(np.max(tip / sensors.tip_noise)))
    return result


def sized(effect: Effect, ref: Reference, sensors: Sensors, size: float) -> Effect:
    """The effect scaled to the multiple of the noise, or as near as is plausible."""
    low, high = effect.limits(ref)
    value = getattr(effect, effect.amplitude)
    for _ in range(8):
        now = multiple(effect, ref, sensors)
        new = float(np.clip(value * size / now if now > 0.0 else value * 4.0, low, high))
        effect = effect.scaled(new)
        if abs(new / value - 1.0) < 0.02:
            break
        value = new
    return effect.scaled(float(f"{getattr(effect, effect.amplitude):.5g}"))
