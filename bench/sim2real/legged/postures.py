"""Motions whose every posture is known beforehand: standing on all feet, and hanging."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from bench.sim2real.legged.legs import Legs
from bench.sim2real.legged.robots import Robot
from bench.sim2real.legged.spec import Array

GRID = 0.01  # of postures [s]
SQUEEZE = 90.0  # of two soles, apart and together, as hips strive against one another [N]
PULL = (1200.0, 250.0)  # of the centre of mass to where it should be [N/m], [N s/m]


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """What the robot's computer knows."""

    base: Array  # (7,)
    velocity: Array  # (3,) of the base in the world [m/s]
    omega: Array  # (3,) in the base's frame [rad/s]
    q: Array  # (n,) as the encoders say


class Path:
    """Postures on a grid, smooth between."""

    def __init__(
        self, robot: Robot, time: Array, q: Array, torque: Array, balance: Balance | None = None
    ) -> None:
        """Joints and what holds them, (T, n)."""
        self.robot, self.end, self.balance = robot, float(time[-1]), balance
        self._q, self._torque = CubicSpline(time, q), CubicSpline(time, torque)
        self._dq = self._q.derivative()

    def command(self, t: float, state: State) -> Array:
        """Position (n,) that is sent: what the torque needs is added as deflection."""
        t = min(t, self.end)
        torque = self._torque(t) + self.robot.kd * self._dq(t)
        if self.balance is not None:
            torque = torque + self.balance.torque(t, state)
        return np.asarray(self._q(t) + torque / self.robot.kp)


class Balance:
    """Pulls the centre of mass of a robot on soles to where the posture has it."""

    def __init__(self, legs: Legs, time: Array, com: Array, parts: Array) -> None:
        """Centre of mass (T, 2), and torques (T, n, 2) by newton in x and y."""
        self.legs = legs
        self._com, self._parts = CubicSpline(time, com), parts
        self._speed = self._com.derivative()

    def torque(self, t: float, state: State) -> Array:
        """Torques of the joints, (n,) [N m]."""
        self.legs.put(state.base, state.q)
        off = self._com(t) - self.legs.com()[:2]
        arm = self.legs.com() - state.base[:3]
        wx, wy, wz = self.legs.turned(state.omega)
        swept = np.array([wy * arm[2] - wz * arm[1], wz * arm[0] - wx * arm[2]])
        speed = state.velocity[:2] + swept
        force = PULL[0] * off + PULL[1] * (self._speed(t) - speed)
        force[1] *= 0.3  # soles are narrow
        return np.asarray(self._parts[round(t / GRID)] @ force)


def home(robot: Robot) -> tuple[Array, Array]:
    """Base pose (7,) and feet's links (feet, 3) of the robot that stands at the origin."""
    base = np.array([0.0, 0.0, robot.height, 1.0, 0.0, 0.0, 0.0])
    pad = robot.pads[0]
    height = pad.radius - pad.center[2]
    feet = np.column_stack([robot.hips, np.full(len(robot.feet), height)])
    return base, feet


def grid(seconds: float) -> Array:
    """Times of the postures, (T,)."""
    return np.arange(0.0, seconds + GRID, GRID)


def stand(legs: Legs, seconds: float, rng: np.random.Generator) -> Path:
    """All feet down: it sways, squats, rolls and pitches; arms move; paws scrub."""
    robot, time = legs.robot, grid(seconds)
    base, feet = home(robot)
    ease, pace = eased(time, seconds), rng.uniform(0.7, 1.2)
    moves, scrub = (_sway_h1 if legs.flat else _sway_go2)(rng, time, pace)
    moves = moves * ease[:, None]
    q = legs.solved(base, robot.rest.copy(), feet, steps=12)
    upper = _arms(robot, time, rng, pace) * ease[:, None]
    rest, legs_end = robot.rest.copy(), robot.legs[-1].stop
    share = np.ones(len(feet))
    squeeze = SQUEEZE * ease * sines(rng, pace * time, [(0.15, 0.3, 0.75), (0.4, 0.7, 0.35)])
    rows, torques, com, parts = [], [], [], []
    for k in range(len(time)):
        turn = Rotation.from_euler("xyz", moves[k, 3:])
        pose = np.concatenate([base[:3] + moves[k, :3], turn.as_quat(scalar_first=True)])
        q[legs_end:] = rest[legs_end:] + upper[k]
        targets = feet.copy()
        targets[:, :2] += scrub[k] * ease[k]
        q = legs.solved(pose, q, targets, steps=2)
        rows.append(q)
        torques.append(legs.torque(share))
        if legs.flat:
            torques[-1] += squeeze[k] * legs.squeeze()
            com.append(legs.com()[:2])
            parts.append(legs.torque(share, np.ones(2)))
    balance = Balance(legs, time, np.array(com), np.array(parts)) if legs.flat else None
    return Path(robot, time, np.array(rows), np.array(torques), balance)


def _sway_go2(rng: np.random.Generator, time: Array, pace: float) -> tuple[Array, Array]:
    """Base motion (T, 6): x y z roll pitch yaw; paws' wish (T, 4, 2), which they rub along."""
    sizes = [
        [(0.2, 0.5, 0.020), (0.6, 1.4, 0.009), (1.6, 2.4, 0.002)],
        [(0.2, 0.5, 0.018), (0.6, 1.4, 0.008), (1.6, 2.4, 0.002)],
        [(0.15, 0.4, 0.025), (0.6, 1.4, 0.012), (1.6, 2.4, 0.003)],
        [(0.2, 0.5, 0.10), (0.6, 1.4, 0.035)],
        [(0.2, 0.5, 0.08), (0.6, 1.4, 0.04)],
        [(0.2, 0.5, 0.10), (0.6, 1.4, 0.04)],
    ]
    base = [sines(rng, pace * time, bands) for bands in sizes]
    base[2] -= 0.015
    wish = [(0.3, 0.6, 0.010), (0.7, 1.4, 0.006)]
    scrub = np.array([[sines(rng, pace * time, wish) for _ in range(2)] for _ in range(4)])
    return np.array(base).T, scrub.transpose(2, 0, 1)


def _sway_h1(rng: np.random.Generator, time: Array, pace: float) -> tuple[Array, Array]:
    """The same on soles without a roll joint: ahead and back, up and down, pitch and yaw."""
    base = np.zeros((len(time), 6))
    base[:, 0] = sines(rng, pace * time, [(0.1, 0.25, 0.018), (0.3, 0.6, 0.008)])
    base[:, 2] = sines(rng, pace * time, [(0.12, 0.3, 0.045), (0.4, 0.8, 0.02)]) - 0.05
    base[:, 4] = sines(rng, pace * time, [(0.15, 0.3, 0.06), (0.4, 0.9, 0.03)])
    base[:, 5] = sines(rng, pace * time, [(0.15, 0.4, 0.08), (0.5, 0.9, 0.03)])
    return base, np.zeros((len(time), 2, 2))


def _arms(robot: Robot, time: Array, rng: np.random.Generator, pace: float) -> Array:
    """Joints beyond the legs, (T, n - legs), about their rest [rad]."""
    count = robot.n - robot.legs[-1].stop
    bands = [(0.15, 0.35, 0.35), (0.4, 0.9, 0.18)]
    moves = np.array([sines(rng, pace * time, bands) for _ in range(count)])
    return moves.T.reshape(len(time), count)


def hang(legs: Legs, hold: Array, seconds: float, rng: np.random.Generator) -> Path:
    """The base is held: every joint goes from angle to angle, and swings."""
    robot, time = legs.robot, grid(seconds)
    pace = rng.uniform(0.8, 1.3)
    low = np.maximum(robot.lower + 0.1, robot.rest - _REACH[robot.name][0])
    high = np.minimum(robot.upper - 0.1, robot.rest + _REACH[robot.name][1])
    ease = eased(time, seconds, ramp=1.0)
    q = np.empty((len(time), robot.n))
    for j in range(robot.n):
        middle, half = 0.5 * (low[j] + high[j]), 0.5 * (high[j] - low[j])
        slow = visits(rng, time, middle - 0.7 * half, middle + 0.7 * half, pace * 1.6)
        quick = sines(rng, pace * time, [(0.5, 1.0, 0.12 * half), (1.2, 2.4, 0.06 * half)])
        q[:, j] = robot.rest[j] + ease * (slow + quick - robot.rest[j])
    q = np.clip(q, robot.lower + 0.02, robot.upper - 0.02)
    torques = np.empty_like(q)
    for k in range(len(time)):
        legs.put(hold, q[k])
        torques[k] = legs.gravity()
    return Path(robot, time, q, torques)


_OUT, _IN = [0.8, 0.9, 0.7, 0.8], [0.8, 0.2, 0.7, 0.8]  # shoulders roll out further than in
_REACH: dict[str, tuple[Array, Array]] = {
    "go2": (np.array([0.5, 0.9, 0.8] * 4), np.array([0.5, 0.9, 0.7] * 4)),
    "h1": (
        np.array([*[0.4, 0.35, 0.7, 0.7, 0.4] * 2, 0.9, *_IN, *_OUT]),
        np.array([*[0.4, 0.35, 0.7, 0.7, 0.6] * 2, 0.9, *_OUT, *_IN]),
    ),
}
"""How far each joint goes below and above its rest [rad]."""


def sines(rng: np.random.Generator, time: Array, bands: list[tuple[float, float, float]]) -> Array:
    """A sum of sines, (T,), one for each (lowest, highest frequency [Hz], amplitude)."""
    total = np.zeros_like(time)
    for low, high, size in bands:
        f, phase = rng.uniform(low, high), rng.uniform(0.0, 2.0 * np.pi)
        total += size * rng.uniform(0.7, 1.1) * np.sin(2.0 * np.pi * f * time + phase)
    return total


def eased(time: Array, seconds: float, ramp: float = 1.5) -> Array:
    """One in the middle, smoothly zero at both ends, (T,)."""
    edge = np.clip(np.minimum(time, seconds - time) / ramp, 0.0, 1.0)
    return np.asarray(edge**3 * (10.0 - 15.0 * edge + 6.0 * edge**2))


def visits(rng: np.random.Generator, time: Array, low: float, high: float, pace: float) -> Array:
    """Quintics from value to value between low and high, with short rests, (T,)."""
    result = np.empty_like(time)
    begin, value = 0.0, float(rng.uniform(low, high))
    while begin < time[-1] + 1e-9:
        goal = float(rng.uniform(low, high))
        lasts = max(0.25, abs(goal - value) / pace * 1.875)
        rest = float(rng.choice([0.0, 0.0, 0.3]))
        s = np.clip((time - begin) / lasts, 0.0, 1.0)
        now = (time >= begin) & (time < begin + lasts + rest)
        step = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        result[now] = (value + (goal - value) * step)[now]
        begin, value = begin + lasts + rest, goal
    result[-1] = result[-2] if len(result) > 1 else result[-1]
    return result
