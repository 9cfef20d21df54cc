"""Controllers of the machines: what nobody tells the diagnosis of."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from bench.sim2real.machines.chain import bodies_in_base, inverse_dynamics, poses
from bench.sim2real.machines.figures import INDEX, Array

KINDS = ("pd", "pid", "cascade", "computed_torque")
_DELAY = INDEX["delay"]
_TICK = 1e-3
_GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """Gains (n,) and what is fed forward from the model that the controller believes.

    pd: kp e + kd de; pid: with ki, too; cascade: kd (kp e + dq_des - dq) + ki of the same;
    computed_torque: kp and kd are those of the acceleration.
    """

    kind: str
    kp: Array
    kd: Array
    ki: Array
    most: Array  # of the integral's torque [N m]
    filter: float  # time constant of the speed's filter [s]
    gravity: float  # share of the model's gravity torque that is fed forward
    inertia: float  # share of the model's torque for the wanted acceleration
    rotor: Array  # (n,) that the feed-forward believes [kg m^2]
    knows_speed: bool  # dq_des is used

    def arrays(self) -> tuple[Array, Array]:
        flags = np.array(
            [KINDS.index(self.kind), self.filter, self.gravity, self.inertia, self.knows_speed],
            dtype=float,
        )
        return flags, np.array([self.kp, self.kd, self.ki, self.most, self.rotor])


@njit(cache=True)
def law(flags, gains, believed, memory, read, q_des, dq_des, k, F, command):
    """Torques (n,) at tick k; commands come as late as each joint's delay."""
    n = len(read)
    kind, share = int(flags[0]), _TICK / (_TICK + flags[1])
    aim, pace, push = np.empty(n), np.zeros(n), np.zeros(n)
    for j in range(n):
        row = max(0, k - int(np.rint(F[j, _DELAY] / _TICK)))
        before = max(0, row - 1)
        aim[j] = q_des[row, j]
        if flags[4] > 0.0:
            pace[j] = dq_des[row, j]
            push[j] = (dq_des[row, j] - dq_des[before, j]) / _TICK
        if memory[3, j] == 0.0:
            memory[1, j], memory[3, j] = read[j], 1.0
        memory[2, j] += share * ((read[j] - memory[1, j]) / _TICK - memory[2, j])
        memory[1, j] = read[j]
    wanted = np.zeros(n)
    for j in range(n):
        e, d = aim[j] - read[j], pace[j] - memory[2, j]
        if kind == 2:
            d += gains[0, j] * e
            memory[0, j] += _TICK * gains[2, j] * d
            command[j] = gains[1, j] * d
        else:
            memory[0, j] += _TICK * gains[2, j] * e
            command[j] = gains[0, j] * e + gains[1, j] * d
        memory[0, j] = min(max(memory[0, j], -gains[3, j]), gains[3, j])
        if kind == 3:
            wanted[j] = push[j] + command[j]
            command[j] = 0.0
        else:
            wanted[j] = flags[3] * push[j]
        command[j] += memory[0, j]
    if flags[2] > 0.0 or flags[3] > 0.0 or kind == 3:
        R, p, z = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
        com, inertia, tau = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty(n)
        poses(believed, read, R, p, z)
        bodies_in_base(believed, R, p, com, inertia)
        nothing, speed = np.zeros(3), np.zeros(n)
        gravity = flags[2] * _GRAVITY
        inverse_dynamics(
            believed, p, z, com, inertia, speed, wanted, gravity, nothing, nothing, tau
        )
        for j in range(n):
            command[j] += tau[j] + gains[4, j] * wanted[j]
