"""Drives, controller and sensors of one machine, drawn at random within what is usual."""

from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.reference import Reference
from bench.sim2real.frame.arm import Arm, Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """Position control at a fixed period, its output held between two ticks."""

    kp: Array  # (n,) [N m/rad]
    kd: Array  # (n,) [N m s/rad]
    period: float  # [s]
    gravity_compensation: bool
    knows_speed: bool  # uses, and logs, dq_des


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensors:
    """Standard deviations and steps of what is logged."""

    q_step: Array  # (n,) of the encoders [rad]
    q_noise: Array  # (n,) [rad]
    dq_noise: Array  # (n,) [rad/s]
    tau_noise: Array  # (n,) [N m]
    tau_step: Array  # (n,) [N m]
    tip_noise: float  # [m]
    tip_turn_noise: float  # [rad]
    log_period: float  # [s]
    jitter: float  # of the rows' times, in controller ticks
    dropped: float  # share of rows lost
    tau_cmd: bool
    dq: bool
    tip: bool

    @property
    def q_seen(self) -> Array:
        """Standard deviations (n,) of positions, quantisation with them [rad]."""
        return np.hypot(self.q_noise, self.q_step / np.sqrt(12.0))


def rotors(arm: Arm, rng: np.random.Generator) -> Array:
    """Inertia of each rotor seen at its joint: strong drives have heavy ones [kg m^2]."""
    return np.array(
        [float(f"{value:.3g}") for value in arm.efforts * rng.uniform(1.5e-3, 5e-3, arm.n)]
    )


def controller(ref: Reference, rng: np.random.Generator, *, tight: bool, soft: bool) -> Controller:
    """Gains for natural frequencies of 3 to 9 Hz (tight: 10 to 15, soft: 1.5 to 3)."""
    n = ref.arm.n
    low, high = (1.5, 3.0) if soft else (10.0, 15.0) if tight else (3.0, 9.0)
    hertz = rng.uniform(low, high)
    omega, zeta = 2.0 * np.pi * hertz * rng.uniform(0.85, 1.15, n), rng.uniform(0.7, 1.0)
    period = 1e-3 if tight or rng.random() < 0.7 else 2e-3
    damping = 2.0 * zeta * omega * ref.inertia
    # kd dt / m stays low for the lightest inertia, and for the rotor alone inside a play
    slack = min(0.35 / np.max(damping / ref.lightest), 0.6 / np.max(damping / ref.armature))
    omega = omega * min(1.0, slack / period)
    digits = np.vectorize(lambda value: float(f"{value:.4g}"))
    return Controller(
        kp=digits(omega**2 * ref.inertia),
        kd=digits(2.0 * zeta * omega * ref.inertia),
        period=period,
        gravity_compensation=bool(tight or soft or rng.random() < 0.8),
        knows_speed=bool(tight or soft or rng.random() < 0.75),
    )


def sensors(ref: Reference, control: Controller, rng: np.random.Generator) -> Sensors:
    """Torque noise about one percent of what each drive usually gives, less of its effort."""
    n, usual = ref.arm.n, np.quantile(np.abs(ref.tau), 0.9, axis=0)
    tau_noise = np.maximum(
        usual * rng.uniform(0.004, 0.012, n), ref.arm.efforts * rng.uniform(1e-3, 3e-3, n)
    )
    # noise that the controller turns into torque stays well below the torque sensor's own
    q_step = np.minimum(2.0 * np.pi / 2.0 ** rng.integers(17, 20), 0.5 * tau_noise / control.kp)
    dq_noise = np.minimum(rng.uniform(1e-3, 4e-3, n), 0.4 * tau_noise / control.kd)
    return Sensors(
        q_step=q_step,
        q_noise=0.4 * q_step,
        dq_noise=dq_noise,
        tau_noise=tau_noise,
        tau_step=tau_noise * rng.uniform(0.2, 1.0),
        tip_noise=float(rng.uniform(1e-4, 4e-4)),
        tip_turn_noise=float(rng.uniform(3e-4, 1e-3)),
        log_period=float(rng.choice([0.004, 0.004, 0.005])),
        jitter=float(rng.uniform(0.0, 0.6)),
        dropped=float(rng.uniform(0.0, 0.01)),
        tau_cmd=bool(rng.random() < 0.6),
        dq=bool(rng.random() < 0.85),
        tip=bool(rng.random() < 0.15),
    )
