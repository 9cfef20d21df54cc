"""One machine as it leaves the workshop: figures within what datasheets and papers give."""

from dataclasses import dataclass, replace

import numpy as np

from bench.sim2real.frame.arm import Arm, Link
from bench.sim2real.machines.chain import chain_of
from bench.sim2real.machines.control import KINDS, Controller
from bench.sim2real.machines.figures import INDEX, Array, Figures
from bench.sim2real.machines.simulate import torque_of

_FASTEST = 1200.0  # oscillation of a link on its gear; what is faster nobody sees [rad/s]
GEARS = ("strain_wave", "planetary", "direct")


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensors:
    """What the log is made of."""

    period: float  # of the rows [s]
    jitter: float  # of the rows' times, standard deviation [s]
    stale: float  # share of values that repeat the row before
    lost: float  # share of rows
    clock: float  # relative error of the log's clock
    bits: Array  # (n,) of the encoders per turn
    speed_filter: float  # time constant of the logged speed [s]
    current_filter: float  # of the logged torque [s]
    current_gain: Array  # (n,) error of the current sensors, relative
    current_offset: Array  # (n,) [N m]
    current_drift: Array  # (n,) [N m] over an hour
    white: Array  # (n,) noise of the torque [N m]
    coloured: Array  # (n,) the same, slowly changing
    colour_rate: float  # corner of its spectrum [Hz]
    torque_step: Array  # (n,) [N m]
    dq: bool
    commands: bool  # q_des is logged
    speeds: bool  # dq_des too


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """What is true, what is believed, who controls it and who looks."""

    gear: str
    arm: Arm  # truly
    believed: Arm  # as the URDF says
    given_rotor: Array | None  # (n,) as the study says
    figures: Figures
    rated: Array  # (n,) [N m]
    control: Controller
    sensors: Sensors


def machine(arm: Arm, rng: np.random.Generator) -> Machine:
    """Draws everything but motions, days and faults."""
    gear = str(rng.choice(GEARS, p=[0.55, 0.3, 0.15]))
    rated = 0.5 * np.array([joint.effort for joint in arm.joints])
    figures = _figures(arm, gear, rated, rng)
    figures = _structure(figures, arm, rng)
    believed = misjudged(arm, rng)
    rotor = figures.of("rotor") * rng.uniform(0.9, 1.1, arm.n)
    return Machine(
        gear=gear,
        arm=arm,
        believed=believed,
        given_rotor=np.array([float(f"{value:.3g}") for value in rotor])
        if rng.random() < 0.5
        else None,
        figures=figures,
        rated=rated,
        control=_control(arm, believed, figures, rated, rng),
        sensors=_sensors(gear, rated, rng),
    )


def misjudged(arm: Arm, rng: np.random.Generator) -> Arm:
    """As drawings have it: masses and inertias 5 to 15 % off, centres by millimetres."""
    links = []
    for link in arm.links:
        scale = 1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.15)
        root = np.eye(3) + np.diag(rng.uniform(-0.04, 0.04, 3))  # stays a body's inertia
        size = float(np.sqrt(np.trace(link.inertia) / link.mass))
        links.append(
            Link(
                mass=link.mass * scale,
                com=link.com + 0.06 * size * rng.normal(size=3),
                inertia=scale * root @ link.inertia @ root.T,
            )
        )
    return replace(arm, links=tuple(links))


def _figures(arm: Arm, gear: str, rated: Array, rng: np.random.Generator) -> Figures:
    n = arm.n
    ratio = {"strain_wave": rng.choice([50, 80, 100, 120, 160], n)}.get(
        gear, rng.choice([6, 9, 20, 40], n)
    )
    uniform = rng.uniform
    figures = Figures.empty(n)
    efforts = 2.0 * rated
    rotor = efforts * uniform(1.5e-3, 5e-3, n) * (0.4 if gear == "direct" else 1.0)
    friction = rated * uniform(0.05, 0.15, n) * (0.5 if gear == "direct" else 1.0)
    split = uniform(0.45, 0.8, n)
    stiffness = rated / (uniform(1e-3, 3e-3, n) if gear != "direct" else uniform(3e-4, 8e-4, n))
    lightest = _own_inertia(arm, np.zeros(n))
    stiffness = np.minimum(stiffness, _FASTEST**2 * np.minimum(lightest, rotor))
    wave = gear == "strain_wave"
    loss = uniform(0.02, 0.08, n) if gear != "direct" else uniform(0.0, 0.01, n)
    values = {
        "gain": 1.0 + rng.choice([-1.0, 1.0], n) * uniform(0.0, 0.02, n),
        "lag": uniform(8e-4, 3e-3, n),
        "limit": efforts,
        "stall": efforts * uniform(1.5, 2.5, n),
        "no_load": np.array([joint.speed for joint in arm.joints]) * uniform(1.6, 2.4, n),
        "cogging": rated * uniform(0.002, 0.008, n),
        "cogging_cycles": ratio * rng.choice([4, 6, 8, 12], n).astype(float),
        "cogging_phase": uniform(0.0, 6.28, n),
        "rotor": rotor,
        "coulomb": friction * split,
        "stiction": friction * split * uniform(0.05, 0.5, n),
        "stribeck_speed": uniform(0.02, 0.2, n),
        "stribeck_shape": uniform(0.6, 2.0, n),
        "viscous": friction * (1.0 - split),
        "viscous_power": uniform(0.6, 1.0, n),
        "load_share": uniform(0.0, 0.03, n),
        "asymmetry": uniform(-0.12, 0.12, n),
        "bristle": uniform(3e-4, 1.5e-3, n),
        "turn_share": uniform(0.0, 0.12, n),
        "turn_phase": uniform(0.0, 6.28, n),
        "warm": uniform(0.01, 0.025, n),
        "warm_level": uniform(0.002, 0.006, n),
        "stiffness": stiffness,
        "hardening": stiffness * uniform(0.0, 3e4, n),
        "gear_damping": uniform(0.05, 0.2, n) * np.sqrt(stiffness * rotor),
        "gap": np.zeros(n) if gear != "planetary" else uniform(3e-4, 1.2e-3, n),
        "hysteresis": rated * (uniform(0.005, 0.03, n) if wave else uniform(0.0, 0.005, n)),
        "hysteresis_twist": uniform(1e-4, 4e-4, n),
        "loss_driving": loss,
        "loss_driven": loss * uniform(1.0, 1.8, n),
        "error": uniform(3e-5, 1.2e-4, n) if wave else uniform(0.0, 3e-5, n),
        "error_cycles": 2.0 * ratio,
        "error_phase": uniform(0.0, 6.28, n),
    }
    for name, column in values.items():
        figures.joints[:, INDEX[name]] = column
    return figures


def _structure(figures: Figures, arm: Arm, rng: np.random.Generator) -> Figures:
    """A resonance of the structure at the tip."""
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    return figures.with_whole(
        mode_mass=float(rng.uniform(0.02, 0.08) * arm.links[-1].mass),
        mode_rate=float(2.0 * np.pi * rng.uniform(9.0, 25.0)),
        mode_loss=float(rng.uniform(0.01, 0.04)),
        mode_x=float(way[0]),
        mode_y=float(way[1]),
        mode_z=float(way[2]),
    )


def _control(
    arm: Arm, believed: Arm, figures: Figures, rated: Array, rng: np.random.Generator
) -> Controller:
    kind = str(rng.choice(KINDS, p=[0.25, 0.2, 0.4, 0.15]))
    middle = np.array([0.5 * (joint.lower + joint.upper) for joint in arm.joints])
    inertia = _own_inertia(believed, np.clip(middle, -2.0, 2.0)) + figures.of("rotor")
    n = arm.n
    omega = 2.0 * np.pi * rng.uniform(2.5, 7.0) * rng.uniform(0.85, 1.15, n)
    zeta = rng.uniform(0.7, 1.0)
    kp, kd, ki = omega**2 * inertia, 2.0 * zeta * omega * inertia, np.zeros(n)
    if kind == "pid":
        ki = kp * rng.uniform(0.5, 2.0)
    if kind == "cascade":
        fast = 2.0 * np.pi * rng.uniform(8.0, 18.0)
        kd = inertia * fast
        kp, ki = np.full(n, fast / rng.uniform(4.0, 7.0)), kd * fast / rng.uniform(4.0, 10.0)
    if kind == "computed_torque":
        kp, kd = omega**2, 2.0 * zeta * omega
    digits = np.vectorize(lambda value: float(f"{value:.3g}"))
    forward = kind in ("cascade", "computed_torque") or rng.random() < 0.6
    return Controller(
        kind=kind,
        kp=digits(kp),
        kd=digits(kd),
        ki=digits(ki),
        most=0.6 * 2.0 * rated,
        filter=float(rng.uniform(8e-4, 4e-3)),
        gravity=1.0 if kind == "computed_torque" else float(forward),
        inertia=float(rng.choice([0.0, 0.8, 1.0])) if kind == "cascade" else 0.0,
        rotor=figures.of("rotor") * rng.uniform(0.7, 1.3, n),
        knows_speed=bool(kind in ("cascade", "computed_torque") or rng.random() < 0.7),
    )


def _own_inertia(arm: Arm, q: Array) -> Array:
    """The mass matrix's diagonal, (n,)."""
    chain, none = chain_of(arm), np.zeros(3)
    still = np.zeros(arm.n)
    return np.array(
        [torque_of(chain, q, still, row, none)[k] for k, row in enumerate(np.eye(arm.n))]
    )


def _sensors(gear: str, rated: Array, rng: np.random.Generator) -> Sensors:
    n = len(rated)
    period = float(rng.choice([0.004, 0.005, 0.008, 0.01, 0.02], p=[0.2, 0.15, 0.25, 0.25, 0.15]))
    return Sensors(
        period=period,
        jitter=period * float(rng.choice([0.0, 0.02, 0.1])),
        stale=float(rng.choice([0.0, 0.002, 0.01])),
        lost=float(rng.choice([0.0, 0.002, 0.01])),
        clock=float(rng.normal(0.0, 3e-5)),
        bits=rng.integers(12, 17, n).astype(float)
        if gear == "planetary"
        else np.full(n, float(rng.integers(14, 17))),
        speed_filter=float(rng.uniform(2e-3, 1.2e-2)),
        current_filter=float(rng.uniform(1e-3, 6e-3)),
        current_gain=rng.choice([-1.0, 1.0], n) * rng.uniform(0.03, 0.05, n),
        current_offset=rated * rng.normal(0.0, 0.006, n),
        current_drift=rated * rng.normal(0.0, 0.01, n),
        white=rated * rng.uniform(0.003, 0.01, n),
        coloured=rated * rng.uniform(0.001, 0.005, n),
        colour_rate=float(rng.uniform(0.3, 3.0)),
        torque_step=rated * rng.uniform(5e-4, 4e-3, n),
        dq=bool(rng.random() < 0.85),
        commands=bool(rng.random() < 0.9),
        speeds=bool(rng.random() < 0.4),
    )


def path_torque(machine: Machine, q: Array, dq: Array, ddq: Array, arm: Arm | None = None) -> Array:
    """Rigid-body torques, rotors with them, along a commanded path, (K, n)."""
    chain = chain_of(arm or machine.arm)
    gravity = machine.figures.whole[:3]
    rigid = [torque_of(chain, *row, gravity) for row in zip(q, dq, ddq, strict=True)]
    return np.array(rigid) + machine.figures.of("rotor") * ddq
