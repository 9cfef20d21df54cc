"""The machine's equations of motion, compiled: drive, rotor, bearing, gear and link of each joint.

A state is nine numbers per joint, then the mode's place and speed: rotor angle and speed, link
angle and speed, bristle (-1 to 1), twist of the gear's inner friction (-1 to 1), drag of the cable
(-1 to 1), believed torque of the current loop, angle that the link has slipped.
"""

import numpy as np
from numba import njit

from bench.sim2real.machines.chain import (
    bodies_in_base,
    cross,
    inverse_dynamics,
    mass_matrix,
    poses,
    solve,
)
from bench.sim2real.machines.figures import INDEX, WHOLE_INDEX

STATES = 9
_CREEP = 0.02  # speed below which directions are not sharp [rad/s]
_REFERENCE = 25.0  # temperature at which the figures hold [deg C]

GAIN, LAG, LIMIT, STALL, NO_LOAD = (INDEX[k] for k in ("gain", "lag", "limit", "stall", "no_load"))
COGGING, COGGING_CYCLES, COGGING_PHASE = (
    INDEX[k] for k in ("cogging", "cogging_cycles", "cogging_phase")
)
ROTOR, COULOMB, STICTION = (INDEX[k] for k in ("rotor", "coulomb", "stiction"))
STRIBECK_SPEED, STRIBECK_SHAPE = (INDEX[k] for k in ("stribeck_speed", "stribeck_shape"))
VISCOUS, VISCOUS_POWER = (INDEX[k] for k in ("viscous", "viscous_power"))
LOAD_SHARE, ASYMMETRY, BRISTLE = (INDEX[k] for k in ("load_share", "asymmetry", "bristle"))
TURN_SHARE, TURN_PHASE = (INDEX[k] for k in ("turn_share", "turn_phase"))
WARM, WARM_LEVEL = (INDEX[k] for k in ("warm", "warm_level"))
STIFFNESS, HARDENING, DAMPING, GAP = (
    INDEX[k] for k in ("stiffness", "hardening", "gear_damping", "gap")
)
HYSTERESIS, HYSTERESIS_TWIST = (INDEX[k] for k in ("hysteresis", "hysteresis_twist"))
DRIVING, DRIVEN = (INDEX[k] for k in ("loss_driving", "loss_driven"))
ERROR, ERROR_CYCLES, ERROR_PHASE = (INDEX[k] for k in ("error", "error_cycles", "error_phase"))
COUPLED = INDEX["coupled"]
SPRING, SPRING_ONSET, SPRING_SIDE = (INDEX[k] for k in ("spring", "spring_onset", "spring_side"))
DRAG, SNAG, SNAG_REACH = (INDEX[k] for k in ("drag", "snag", "snag_reach"))
BRAKE, SLIP = INDEX["brake"], INDEX["slip"]
MODE_MASS, MODE_RATE, MODE_LOSS = (WHOLE_INDEX[k] for k in ("mode_mass", "mode_rate", "mode_loss"))
MODE_X, SPIN, SAG, RATTLE = (WHOLE_INDEX[k] for k in ("mode_x", "spin", "sag", "rattle"))


@njit(cache=True)
def friction(f, speed, bristle, load, angle, warmer, braked):
    """Torque against the motion, and how fast the bristle bends [1/s]."""
    level = f[COULOMB] * (1.0 + f[TURN_SHARE] * np.sin(angle + f[TURN_PHASE]))
    level *= max(0.3, 1.0 - f[WARM_LEVEL] * warmer)
    level *= 1.0 + f[ASYMMETRY] * np.tanh(speed / _CREEP)
    level += f[LOAD_SHARE] * abs(load) + f[BRAKE] * braked
    level += f[STICTION] * np.exp(-((abs(speed) / f[STRIBECK_SPEED]) ** f[STRIBECK_SHAPE]))
    rate = (speed - abs(speed) * bristle) / f[BRISTLE]
    inner = 0.5 * np.sqrt(max(level, 0.0) * f[ROTOR] * f[BRISTLE])  # so that bristles do not ring
    inner *= np.exp(-((speed / 0.05) ** 2))
    smooth = np.tanh(speed / _CREEP) * abs(speed) ** f[VISCOUS_POWER]
    viscous = f[VISCOUS] * np.exp(-f[WARM] * warmer) * smooth
    return level * bristle + inner * rate + viscous, rate


@njit(cache=True)
def gear(y, j, F):
    """Torque on the link, the twist's rate, and the gear's ratio to the rotor as it varies."""
    f, k = F[j], STATES * j
    theta = y[k]
    angle = f[ERROR_CYCLES] * theta + f[ERROR_PHASE]
    twist = theta + f[ERROR] * np.sin(angle) - y[k + 2] - y[k + 8]
    slope = 1.0 + f[ERROR] * f[ERROR_CYCLES] * np.cos(angle)
    rate = slope * y[k + 1] - y[k + 3]
    if j > 0 and f[COUPLED] != 0.0:
        twist += f[COUPLED] * y[k - STATES]
        rate += f[COUPLED] * y[k - STATES + 1]
    half = 0.5 * f[GAP]
    pressed = twist - min(max(twist, -half), half)
    torque = f[STIFFNESS] * pressed + f[HARDENING] * pressed**3 + f[HYSTERESIS] * y[k + 5]
    if half == 0.0 or pressed != 0.0:
        torque += f[DAMPING] * rate
    return torque, rate, slope


@njit(cache=True)
def resistance(y, j, F, warmer, braked):
    """Friction of one joint's bearing and gear in a state [N m]."""
    f, k = F[j], STATES * j
    load = gear(y, j, F)[0]
    share = f[DRIVING] if load * y[k + 1] > 0.0 else f[DRIVEN]
    lost = abs(load) * share * np.tanh(y[k + 1] / _CREEP)
    return lost + friction(f, y[k + 1], y[k + 4], load, y[k + 2], warmer[j], braked[j])[0]


@njit(cache=True)
def believed_torque(f, command, speed):
    """The torque that limit and voltage leave of a command."""
    most = min(f[LIMIT], f[STALL] * max(0.0, 1.0 - speed / f[NO_LOAD]))
    least = -min(f[LIMIT], f[STALL] * max(0.0, 1.0 + speed / f[NO_LOAD]))
    return min(max(command, least), most)


@njit(cache=True)
def rates(y, command, F, W, chain, warmer, braked, push, dy):
    """dy/dt; `push` (3,) acts on the tip in the base's axes, `warmer` (n,) is above 25 deg C."""
    n = len(command)
    R, p, z = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
    com, inertia, M = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, n))
    q, v = np.empty(n), np.empty(n)
    for j in range(n):
        q[j], v[j] = y[STATES * j + 2], y[STATES * j + 3]
    poses(chain, q, R, p, z)
    bodies_in_base(chain, R, p, com, inertia)
    mass_matrix(chain, p, z, com, inertia, M)

    link, extra = np.empty(n), np.zeros(n)  # torques on links; reactions on other rotors
    loaded = 0.0
    for j in range(n):
        loaded += abs(y[STATES * j + 7]) / F[j, LIMIT]
    for j in range(n):
        f = F[j]
        k = STATES * j
        theta, omega = y[k], y[k + 1]
        torque, speed, slope = gear(y, j, F)
        dy[k + 5] = (speed - abs(speed) * y[k + 5]) / f[HYSTERESIS_TWIST]
        dy[k + 8] = 0.0
        if f[SLIP] > 0.0 and abs(torque) > f[SLIP]:
            dy[k + 8] = 0.2 * np.sign(torque) * (abs(torque) / f[SLIP] - 1.0)
        link[j] = torque
        driving = torque * omega > 0.0
        lost = abs(torque) * (f[DRIVING] if driving else f[DRIVEN]) * np.tanh(omega / _CREEP)
        against, dy[k + 4] = friction(f, omega, y[k + 4], torque, y[k + 2], warmer[j], braked[j])
        dy[k + 7] = (believed_torque(f, command[j], omega) - y[k + 7]) / f[LAG]
        motor = f[GAIN] * (1.0 - W[SAG] * loaded) * y[k + 7]
        motor += f[COGGING] * np.sin(f[COGGING_CYCLES] * theta + f[COGGING_PHASE])
        extra[j] += motor - slope * torque - lost - against
        if j > 0 and f[COUPLED] != 0.0:
            extra[j - 1] -= f[COUPLED] * torque
        above = y[k + 2] - f[SPRING_ONSET]
        if f[SPRING_SIDE] == 0.0 or above * f[SPRING_SIDE] > 0.0:
            link[j] -= f[SPRING] * above
        link[j] -= f[DRAG] * v[j] * abs(v[j]) + f[SNAG] * y[k + 6]
        dy[k + 6] = (v[j] - abs(v[j]) * y[k + 6]) / f[SNAG_REACH]
    for j in range(n):
        k = STATES * j
        dy[k] = y[k + 1]
        dy[k + 1] = extra[j] / F[j, ROTOR]
        dy[k + 2] = v[j]

    force, moment = push.copy(), np.zeros(3)
    tip, arm, way, turning = np.empty(3), np.empty(3), np.empty(3), np.zeros(3)
    last = n - 1
    for i in range(3):
        tip[i] = p[last, i]
        way[i] = 0.0
        for j in range(3):
            tip[i] += R[last, i, j] * chain[4][j]
            way[i] += R[last, i, j] * W[MODE_X + j]
        arm[i] = tip[i] - com[last, i]
        for j in range(n):
            turning[i] += z[j, i] * v[j]
    place, pace = y[STATES * n], y[STATES * n + 1]
    bent = place - min(max(place, -W[RATTLE]), W[RATTLE])
    back = W[MODE_RATE] ** 2 * bent
    if W[RATTLE] == 0.0 or bent != 0.0:
        back += 2.0 * W[MODE_LOSS] * W[MODE_RATE] * pace
    for i in range(3):
        force[i] += W[MODE_MASS] * back * way[i]
    cross(arm, force, moment)
    if W[SPIN] != 0.0:
        axle, turned = np.empty(3), np.empty(3)
        for i in range(3):
            axle[i] = R[last, i, 0] * W[SPIN]
        cross(turning, axle, turned)
        for i in range(3):
            moment[i] -= turned[i]
    bias, a, still = np.empty(n), np.empty(n), np.zeros(n)
    inverse_dynamics(chain, p, z, com, inertia, v, still, W[:3], force, moment, bias)
    for j in range(n):
        link[j] -= bias[j]
    solve(M, link, a)
    for j in range(n):
        dy[STATES * j + 3] = a[j]
    dy[STATES * n] = pace
    dy[STATES * n + 1] = 0.0
    if W[MODE_MASS] > 0.0:
        felt = 0.0  # the tip's acceleration along the mode, gravity with it
        lever, swing = np.empty(3), np.empty(3)
        for j in range(n):
            for i in range(3):
                lever[i] = tip[i] - p[j, i]
            cross(z[j], lever, swing)
            felt += a[j] * (swing[0] * way[0] + swing[1] * way[1] + swing[2] * way[2])
        for i in range(3):
            felt -= W[i] * way[i]
        dy[STATES * n + 1] = -back - felt
