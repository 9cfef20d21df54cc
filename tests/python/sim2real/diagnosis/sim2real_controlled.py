"""Joints under control, simulated in a few lines: an inertia, gravity, friction, any law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from pdoik.recordings import Recording, Role
from sim2real_recordings import even_recording

STEP = 1e-3
Law = Callable[[float, float, float, float], float]
"""Effort of time, error, desired speed and measured speed."""


def commanded(time: np.ndarray, seed: int) -> np.ndarray:
    """A few sines, from rest; (T,)."""
    rng = np.random.default_rng(seed)
    rates, sizes = rng.uniform(1.0, 7.0, 4), rng.uniform(0.1, 0.4, 4)
    waves = sizes * np.sin(np.outer(time, rates) + rng.uniform(0, 6, 4))
    return np.minimum(time, 1.0) * waves.sum(axis=1)


@dataclass
class Pid:
    """kp e + ki integral + kd de, delayed, filtered and cut off as asked."""

    kp: float
    kd: float
    ki: float = 0.0
    limit: float = np.inf
    lag: float = 0.0
    delay: int = 0  # steps
    gravity: float = 0.0
    whole: float = field(default=0.0, init=False)
    state: float = field(default=0.0, init=False)
    past: list[float] = field(default_factory=list, init=False)

    def __call__(self, time: float, error: float, speed_error: float, q: float) -> float:
        self.whole += error * STEP
        asked = self.kp * error + self.kd * speed_error + self.ki * self.whole
        asked += self.gravity * np.sin(q)
        if self.lag:
            self.state += (asked - self.state) * (1.0 - np.exp(-STEP / self.lag))
            asked = self.state
        self.past.append(asked)
        asked = self.past[max(len(self.past) - 1 - self.delay, 0)]
        return float(np.clip(asked, -self.limit, self.limit))


@dataclass
class Cascade:
    """A position loop that asks for a speed, held by a PI law."""

    kp: float
    kv: float
    ki: float
    whole: float = field(default=0.0, init=False)

    def __call__(self, time: float, error: float, speed_error: float, q: float) -> float:
        left = self.kp * error + speed_error
        self.whole += left * STEP
        return self.kv * left + self.ki * self.whole


@dataclass
class Table:
    """Stiff near the goal, softer beyond a knee."""

    near: float
    far: float
    knee: float
    kd: float

    def __call__(self, time: float, error: float, speed_error: float, q: float) -> float:
        size = abs(error)
        effort = self.near * min(size, self.knee) + self.far * max(size - self.knee, 0.0)
        return float(np.sign(error) * effort + self.kd * speed_error)


def run(
    law: Law,
    *,
    seed: int,
    seconds: float = 8.0,
    noise: float = 2e-5,
    speed_noise: float = 2e-3,
    effort_noise: float = 0.02,
    moment: float = 2.0,
    inertia: float = 0.3,
    friction: float = 0.3,
    role: Role = "fit",
    aimed: bool = True,
) -> Recording:
    """A recording at 250 Hz; the law sees the noisy positions and speeds that are logged.

    With `aimed` it is told the desired speed, which is logged then.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, STEP)
    goal = commanded(time, seed)
    rate = np.gradient(goal, STEP)
    q, v = goal[0], 0.0
    logged = np.empty((len(time), 3))
    for i, t in enumerate(time):
        seen, speed = q + noise * rng.standard_normal(), v + speed_noise * rng.standard_normal()
        effort = law(t, goal[i] - seen, aimed * rate[i] - speed, seen)
        logged[i] = seen, speed, effort
        force = effort - moment * np.sin(q) - friction * np.tanh(v / 0.01)
        v += STEP * force / inertia
        q += STEP * v
    logged[:, 2] += effort_noise * rng.standard_normal(len(time))
    every = slice(None, None, 4)
    recording = even_recording(
        time[every],
        role=role,
        q=logged[every, :1],
        dq=logged[every, 1:2],
        tau_cmd=logged[every, 2:],
        q_des=goal[every, None],
        dq_des=rate[every, None] if aimed else None,
    )
    return replace(recording, name=f"{role}{seed}.csv")


def swing(
    *, seed: int, gain: float = 3.0, let_go: float = 6.0, given_volts: float = 12.0
) -> dict[str, np.ndarray]:
    """Columns of a voltage-driven pendulum at 200 Hz that lets go at a time.

    Torque per volt 0.5 N m/V, back-EMF 0.4 N m s/rad, rotor 0.02 kg m^2, load 1 kg at 0.3 m.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 10.0, STEP)
    goal = 1.5 * commanded(time, seed)
    moment, inertia = 1.0 * 9.81 * 0.3, 1.0 * 0.09 + 0.02
    q, v = goal[0], 0.0
    rows = np.empty((len(time), 2))
    for i, t in enumerate(time):
        on = t < let_go
        duty = float(np.clip(gain * (goal[i] - q), -1.0, 1.0)) if on else 0.0
        rows[i] = q, duty
        motor = 0.5 * given_volts * duty - 0.4 * v if on else 0.0
        v += STEP * (motor - moment * np.sin(q) - 0.05 * np.tanh(v / 0.01)) / inertia
        q += STEP * v
    every = slice(None, None, 5)
    return {
        "time": time[every],
        "q.joint1": rows[every, 0] + 1e-5 * rng.standard_normal(len(time[every])),
        "q_des.joint1": goal[every],
        "duty.joint1": rows[every, 1],
        "volts": np.full(len(time[every]), given_volts),
    }
