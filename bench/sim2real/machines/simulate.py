"""One recording: a controller's ticks, and between them steps as long as the error allows."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from bench.sim2real.machines.chain import Chain, bodies_in_base, inverse_dynamics, poses
from bench.sim2real.machines.control import Controller, law
from bench.sim2real.machines.figures import INDEX, Array, Figures
from bench.sim2real.machines.physics import STATES, rates, resistance

TICK = 1e-3  # of the controllers [s]
_TOLERANCE = 1e-2  # of a step, relative to the scales below
_SHORTEST = 2e-6  # [s]
_LAGGING = INDEX["delay"]
_OFFSET = INDEX["offset"]
_COULOMB, _VISCOUS = INDEX["coulomb"], INDEX["viscous"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Day:
    """What differs from recording to recording."""

    figures: Figures
    later: Figures  # from `since` on
    since: float  # [s]
    warmer: Array  # (n,) gears' temperature above 25 deg C at the start [K]
    heating: Array  # (n,) kelvin per joule of friction
    cooling: float  # time constant [s]
    braked: Array  # (K, n) 1 where a brake drags
    push: Array  # (K, 3) force on the tip [N]
    reading: Array  # (K, n) noise of the encoders [rad]
    step: Array  # (n,) of the encoders [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """What was true at each tick; (K, n)."""

    time: Array  # (K,)
    rotor: Array  # encoders without error [rad]
    speed: Array  # [rad/s]
    read: Array  # encoders as they are read [rad]
    link: Array  # [rad]
    torque: Array  # as the drives believe [N m]
    command: Array  # [N m]
    friction: Array  # of bearing and gear, against the motion [N m]


def simulate(
    chain: Chain, believed: Chain, control: Controller, day: Day, q_des: Array, dq_des: Array
) -> Track:
    """All ticks, from rest at the first command."""
    ticks, n = q_des.shape
    track = np.zeros((7, ticks, n))
    flags, gains = control.arrays()
    state = _rest(chain, day.figures, q_des[0])
    figures = (day.figures.joints, day.figures.whole), (day.later.joints, day.later.whole)
    switch = round(min(day.since, 1e6) / TICK)
    heat = (day.warmer.copy(), day.heating, day.cooling)
    around = (day.braked, day.push, day.reading, day.step)
    wanted = (np.ascontiguousarray(q_des), np.ascontiguousarray(dq_des))
    controller = (flags, gains, believed)
    whole = _run(chain, controller, figures, switch, heat, around, wanted, state, track)
    if not whole or np.max(np.abs(track[0] - q_des)) > 1.5:
        raise RuntimeError("the simulated machine left its path")
    rotor, speed, read, link, torque, command, friction = track
    return Track(
        time=TICK * np.arange(ticks),
        rotor=rotor,
        speed=speed,
        read=read,
        link=link,
        torque=torque,
        command=command,
        friction=friction,
    )


def _rest(chain: Chain, figures: Figures, q: Array) -> Array:
    """Standing still, gears twisted by the load; (9 n + 2,)."""
    n = len(q)
    load = gravity_torque(chain, q, figures.whole[:3])
    state = np.zeros(STATES * n + 2)
    for j in range(n):
        state[STATES * j] = q[j] + load[j] / figures.of("stiffness")[j]
        state[STATES * j + 2] = q[j]
        state[STATES * j + 7] = load[j]
    for j in range(1, n):
        state[STATES * j] -= figures.of("coupled")[j] * state[STATES * (j - 1)]
    return state


def gravity_torque(chain: Chain, q: Array, gravity: Array) -> Array:
    """Torques that hold the chain still, (n,)."""
    still = np.zeros(len(q))
    return torque_of(chain, q, still, still, gravity)


@njit(cache=True)
def torque_of(chain, q, v, a, gravity):
    """Inverse dynamics, (n,)."""
    n = len(q)
    R, p, z = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
    com, inertia, tau = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty(n)
    poses(chain, q, R, p, z)
    bodies_in_base(chain, R, p, com, inertia)
    nothing = np.zeros(3)
    inverse_dynamics(chain, p, z, com, inertia, v, a, gravity, nothing, nothing, tau)
    return tau


@njit(cache=True)
def _error(a, b, n):
    """Largest difference of two states over what is small for each kind of number."""
    worst = 0.0
    for j in range(n):
        k = STATES * j
        for c in range(4):
            small = 1e-3 if c % 2 == 0 else 3e-2
            worst = max(worst, abs(a[k + c] - b[k + c]) / small)
        worst = max(worst, abs(a[k + 4] - b[k + 4]) / 3.0)
    return worst


@njit(cache=True)
def _advance(y, span, h, command, F, W, chain, warmer, braked, push, work):
    """One tick by Bogacki and Shampine's pair of order 3(2); the last step's length."""
    n = len(command)
    k1, k2, k3, k4, at, new = work[0], work[1], work[2], work[3], work[4], work[5]
    rates(y, command, F, W, chain, warmer, braked, push, k1)
    done = 0.0
    while done < span:
        last = h >= span - done
        step = span - done if last else h
        for i in range(len(y)):
            at[i] = y[i] + 0.5 * step * k1[i]
        rates(at, command, F, W, chain, warmer, braked, push, k2)
        for i in range(len(y)):
            at[i] = y[i] + 0.75 * step * k2[i]
        rates(at, command, F, W, chain, warmer, braked, push, k3)
        for i in range(len(y)):
            new[i] = y[i] + step * (2.0 * k1[i] + 3.0 * k2[i] + 4.0 * k3[i]) / 9.0
        rates(new, command, F, W, chain, warmer, braked, push, k4)
        for i in range(len(y)):
            at[i] = y[i] + step * (7.0 / 24.0 * k1[i] + 0.25 * k2[i] + k3[i] / 3.0 + 0.125 * k4[i])
        error = _error(new, at, n) / _TOLERANCE
        if error <= 1.0 or step <= _SHORTEST:
            done += step
            for i in range(len(y)):
                y[i] = new[i]
                k1[i] = k4[i]
            for j in range(n):
                for c in range(4, 7):
                    y[STATES * j + c] = min(1.0, max(-1.0, y[STATES * j + c]))
        wanted = step * min(3.0, max(0.2, 0.9 * (1.0 / max(error, 1e-9)) ** (1.0 / 3.0)))
        h = max(wanted, h if last and error <= 1.0 else 0.0, _SHORTEST)
        if not error < 1e12:
            return -1.0
    return h


@njit(cache=True)
def _run(chain, controller, figures, switch, heat, around, wanted, y, track):
    flags, gains, believed = controller
    warmer, heating, cooling = heat
    braked, push, reading, steps = around
    q_des, dq_des = wanted
    ticks, n = q_des.shape
    memory = np.zeros((4, n))  # of the controller: integral, last reading, filtered speed, started
    work = np.empty((6, len(y)))
    h = 1e-4
    command, read = np.empty(n), np.empty(n)
    for k in range(ticks):
        F, W = figures[0] if k < switch else figures[1]
        for j in range(n):
            s = STATES * j
            exact = y[s] + F[j, _OFFSET]
            read[j] = np.rint((exact + reading[k, j]) / steps[j]) * steps[j]
            track[0, k, j], track[1, k, j], track[2, k, j] = exact, y[s + 1], read[j]
            track[3, k, j], track[4, k, j] = y[s + 2], y[s + 7]
        law(flags, gains, believed, memory, read, q_des, dq_des, k, F, command)
        track[5, k] = command
        for j in range(n):
            track[6, k, j] = resistance(y, j, F, warmer, braked[k])
        h = _advance(y, 1e-3, h, command, F, W, chain, warmer, braked[k], push[k], work)
        if h < 0.0:
            return False
        for j in range(n):
            s = STATES * j
            lost = abs(F[j, _COULOMB] * y[s + 1]) + F[j, _VISCOUS] * y[s + 1] ** 2
            warmer[j] += 1e-3 * (heating[j] * lost - warmer[j] / cooling)
            if abs(y[s]) > 50.0:
                return False
    return True
