"""The torques that the true machine's law says along a recording: no simulation, no day's luck.

Bodies, rotors, gears' losses and bearings are the true ones, friction that of a mean day. What it
leaves is the day, the structure, the twist of gears and the sensors: nobody who knows the machine
would leave less.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from bench.sim2real.machines.build import Draft, draft_of
from bench.sim2real.machines.chain import chain_of
from bench.sim2real.machines.figures import INDEX, Array
from bench.sim2real.machines.physics import friction
from bench.sim2real.machines.simulate import torque_of
from bench.sim2real.machines.spec import WorldSpec

_BRISTLE, _COULOMB, _ROTOR = (INDEX[name] for name in ("bristle", "coulomb", "rotor"))
_CREEP = 0.02  # speed below which directions are not sharp [rad/s]
_WARMER = 4.0  # than 25 deg C, on a mean day [K]
_ATTEMPTS = ((0, 1.0), (1, 1.8), (2, 3.2))  # as build.py tries severities


def draft_behind(spec: WorldSpec, faults: list[dict[str, float]]) -> Draft:
    """The draft whose faults have these parameters.

    Raises:
        ValueError: none has: the generator is another one.
    """
    for attempt, severity in _ATTEMPTS:
        draft = draft_of(spec, attempt, severity)
        if [fault.parameters for fault in draft.faults] == faults:
            return draft
    raise ValueError(
        f"seed {spec.seed}: no draft has the truth's faults; was the generator changed?"
    )


def true_torque(draft: Draft, q: Array, dq: Array, ddq: Array, period: float) -> Array:
    """As the log has it, for (T, n) of the joints' motion, faults at work throughout, (T, n)."""
    made, arm = draft.machine, draft.machine.arm
    figures = made.figures
    for fault in draft.faults:
        arm = arm if fault.arm is None else fault.arm(arm)
        figures = figures if fault.figures is None else fault.figures(figures)
    chain, gravity = chain_of(arm), figures.whole[:3]
    q = q - figures.of("offset")
    link = np.array([torque_of(chain, *row, gravity) for row in zip(q, dq, ddq, strict=True)])
    above = q - figures.of("spring_onset")
    side = figures.of("spring_side")
    link += np.where((side == 0.0) | (above * side > 0.0), figures.of("spring") * above, 0.0)
    link += figures.of("drag") * dq * np.abs(dq)
    link[:, :-1] += figures.of("coupled")[1:] * link[:, 1:]
    loss = np.where(link * dq > 0.0, figures.of("loss_driving"), figures.of("loss_driven"))
    motor = link + np.abs(link) * loss * np.tanh(dq / _CREEP) + figures.of("rotor") * ddq
    cogging = figures.of("cogging_cycles") * q + figures.of("cogging_phase")
    motor -= figures.of("cogging") * np.sin(cogging)
    for j in range(arm.n):
        motor[:, j] += _rubbed(figures.joints[j], q[:, j], dq[:, j], link[:, j], period)
    sensors = made.sensors
    return np.asarray(
        motor / figures.of("gain") * (1.0 + sensors.current_gain) + sensors.current_offset
    )


@njit(cache=True)
def _rubbed(f, q, dq, load, period):
    """Friction along a path, bristles bent by it, (T,)."""
    result, bristle = np.empty(len(q)), 0.0
    reach = f[_BRISTLE]
    for k in range(len(q)):
        goal = np.sign(dq[k])
        bristle = goal + (bristle - goal) * np.exp(-abs(dq[k]) * period / reach)
        level, _ = friction(f, dq[k], bristle, load[k], q[k], _WARMER, 0.0)
        rate = (dq[k] - abs(dq[k]) * bristle) / reach
        inner = 0.5 * np.sqrt(max(f[_COULOMB], 0.0) * f[_ROTOR] * reach)
        result[k] = level - inner * np.exp(-((dq[k] / 0.05) ** 2)) * rate
    return result
