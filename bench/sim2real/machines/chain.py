"""Rigid-body dynamics of a serial chain of hinges, compiled; held against Pinocchio in the tests.

Everything is expressed in the base's axes. A chain is four arrays: `rotation` (n, 3, 3) and
`placement` (n, 3) of each joint in its parent at zero, `axis` (n, 3), and `body` (n, 13): mass,
centre (3), inertia about the centre (9) in the joint's own axes.
"""

import numpy as np
from numba import njit

from bench.sim2real.frame.arm import Arm
from bench.sim2real.machines.figures import Array

Chain = tuple[Array, Array, Array, Array, Array]


def chain_of(arm: Arm) -> Chain:
    """The arrays of an arm; the last is the tip's place in the last link, (3,)."""
    placements = np.array([joint.T_parent_joint for joint in arm.joints])
    bodies = [np.concatenate([[b.mass], b.com, b.inertia.ravel()]) for b in arm.links]
    return (
        np.ascontiguousarray(placements[:, :3, :3]),
        np.ascontiguousarray(placements[:, :3, 3]),
        np.array([joint.axis for joint in arm.joints]),
        np.array(bodies),
        np.ascontiguousarray(arm.T_last_tip[:3, 3]),
    )


@njit(cache=True)
def cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def poses(chain, q, R, p, z):
    """Rotation (n, 3, 3), origin (n, 3) and axis (n, 3) of every joint's frame."""
    rotation, placement, axis = chain[0], chain[1], chain[2]
    n = len(q)
    for k in range(n):
        s, c = np.sin(q[k]), np.cos(q[k])
        u0, u1, u2 = axis[k, 0], axis[k, 1], axis[k, 2]
        v = 1.0 - c
        turn = (
            (c + u0 * u0 * v, u0 * u1 * v - u2 * s, u0 * u2 * v + u1 * s),
            (u1 * u0 * v + u2 * s, c + u1 * u1 * v, u1 * u2 * v - u0 * s),
            (u2 * u0 * v - u1 * s, u2 * u1 * v + u0 * s, c + u2 * u2 * v),
        )
        for i in range(3):
            if k == 0:
                a0, a1, a2 = rotation[0, i, 0], rotation[0, i, 1], rotation[0, i, 2]
                p[0, i] = placement[0, i]
            else:
                a0 = a1 = a2 = 0.0
                p[k, i] = p[k - 1, i]
                for j in range(3):
                    a0 += R[k - 1, i, j] * rotation[k, j, 0]
                    a1 += R[k - 1, i, j] * rotation[k, j, 1]
                    a2 += R[k - 1, i, j] * rotation[k, j, 2]
                    p[k, i] += R[k - 1, i, j] * placement[k, j]
            R[k, i, 0] = a0 * turn[0][0] + a1 * turn[1][0] + a2 * turn[2][0]
            R[k, i, 1] = a0 * turn[0][1] + a1 * turn[1][1] + a2 * turn[2][1]
            R[k, i, 2] = a0 * turn[0][2] + a1 * turn[1][2] + a2 * turn[2][2]
            z[k, i] = R[k, i, 0] * u0 + R[k, i, 1] * u1 + R[k, i, 2] * u2


@njit(cache=True)
def bodies_in_base(chain, R, p, com, inertia):
    """Centre (n, 3) and inertia about it (n, 3, 3) of every link."""
    body = chain[3]
    turned = np.empty((3, 3))
    for k in range(len(p)):
        for i in range(3):
            com[k, i] = p[k, i]
            for j in range(3):
                com[k, i] += R[k, i, j] * body[k, 1 + j]
                turned[i, j] = 0.0
                for m in range(3):
                    turned[i, j] += R[k, i, m] * body[k, 4 + 3 * m + j]
        for i in range(3):
            for j in range(3):
                inertia[k, i, j] = 0.0
                for m in range(3):
                    inertia[k, i, j] += turned[i, m] * R[k, j, m]


@njit(cache=True)
def mass_matrix(chain, p, z, com, inertia, M):
    """Composite bodies from the tip inwards, (n, n)."""
    body = chain[3]
    n = len(p)
    mass = 0.0
    centre, whole = np.zeros(3), np.zeros((3, 3))
    momentum, spin, arm, at = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for k in range(n - 1, -1, -1):
        m = body[k, 0]
        total = mass + m
        d0, d1, d2 = com[k, 0] - centre[0], com[k, 1] - centre[1], com[k, 2] - centre[2]
        reduced = mass * m / total
        for i in range(3):
            for j in range(3):
                whole[i, j] += inertia[k, i, j]
        dd = (d0, d1, d2)
        square = d0 * d0 + d1 * d1 + d2 * d2
        for i in range(3):
            whole[i, i] += reduced * square
            for j in range(3):
                whole[i, j] -= reduced * dd[i] * dd[j]
        for i in range(3):
            centre[i] = (mass * centre[i] + m * com[k, i]) / total
        mass = total
        for i in range(3):  # momenta of all that joint k carries, turned at 1 rad/s about its axis
            arm[i] = centre[i] - p[k, i]
        cross(z[k], arm, momentum)
        for i in range(3):
            momentum[i] *= mass
            spin[i] = whole[i, 0] * z[k, 0] + whole[i, 1] * z[k, 1] + whole[i, 2] * z[k, 2]
        for j in range(k + 1):
            for i in range(3):
                arm[i] = centre[i] - p[j, i]
            cross(arm, momentum, at)
            value = 0.0
            for i in range(3):
                value += z[j, i] * (at[i] + spin[i])
            M[j, k] = value
            M[k, j] = value


@njit(cache=True)
def inverse_dynamics(chain, p, z, com, inertia, v, a, gravity, force, moment, tau):
    """Torques (n,) for speeds v and accelerations a, (n,); Newton and Euler.

    `force` and `moment` (3,) about the last link's centre act on the last link from outside.
    """
    body = chain[3]
    n = len(p)
    w, dw, acc = np.zeros(3), np.zeros(3), np.zeros(3)
    for i in range(3):
        acc[i] = -gravity[i]
    f, m = np.empty((n, 3)), np.empty((n, 3))
    d, t1, t2, Iw = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for k in range(n):
        if k > 0:  # the origin's acceleration, moved from joint k - 1 to k
            for i in range(3):
                d[i] = p[k, i] - p[k - 1, i]
            cross(dw, d, t1)
            cross(w, d, t2)
            for i in range(3):
                acc[i] += t1[i]
            cross(w, t2, t1)
            for i in range(3):
                acc[i] += t1[i]
        cross(w, z[k], t1)
        for i in range(3):
            dw[i] += z[k, i] * a[k] + t1[i] * v[k]
        for i in range(3):
            w[i] += z[k, i] * v[k]
        for i in range(3):
            d[i] = com[k, i] - p[k, i]
        cross(dw, d, t1)
        cross(w, d, t2)
        cross(w, t2, Iw)
        for i in range(3):
            f[k, i] = body[k, 0] * (acc[i] + t1[i] + Iw[i])
        for i in range(3):
            Iw[i] = inertia[k, i, 0] * w[0] + inertia[k, i, 1] * w[1] + inertia[k, i, 2] * w[2]
        cross(w, Iw, t1)
        for i in range(3):
            m[k, i] = t1[i]
            for j in range(3):
                m[k, i] += inertia[k, i, j] * dw[j]
    for i in range(3):
        f[n - 1, i] -= force[i]
        m[n - 1, i] -= moment[i]
    total_f, total_m = np.zeros(3), np.zeros(3)
    for k in range(n - 1, -1, -1):
        if k < n - 1:  # the moment, moved from joint k + 1 to k
            for i in range(3):
                d[i] = p[k + 1, i] - p[k, i]
            cross(d, total_f, t1)
            for i in range(3):
                total_m[i] += t1[i]
        for i in range(3):
            d[i] = com[k, i] - p[k, i]
        cross(d, f[k], t1)
        for i in range(3):
            total_m[i] += m[k, i] + t1[i]
            total_f[i] += f[k, i]
        tau[k] = z[k, 0] * total_m[0] + z[k, 1] * total_m[1] + z[k, 2] * total_m[2]


@njit(cache=True)
def solve(M, b, x):
    """M x = b for a symmetric positive definite M, which is overwritten."""
    n = len(b)
    for k in range(n):
        for j in range(k):
            s = M[k, j]
            for i in range(j):
                s -= M[k, i] * M[j, i]
            M[k, j] = s / M[j, j]
        s = M[k, k]
        for i in range(k):
            s -= M[k, i] * M[k, i]
        M[k, k] = np.sqrt(s)
    for k in range(n):
        s = b[k]
        for i in range(k):
            s -= M[k, i] * x[i]
        x[k] = s / M[k, k]
    for k in range(n - 1, -1, -1):
        s = x[k]
        for i in range(k + 1, n):
            s -= M[i, k] * x[i]
        x[k] = s / M[k, k]
