"""Faults of one joint's bearing, gear, drive and encoder."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bench.sim2real.machines.fault import Fault, Log, Scene
from bench.sim2real.machines.figures import Array


def _set(j: int, parameters: dict[str, float], **values: float) -> Fault:
    """Figures of one joint become others, perhaps in the middle of a recording."""
    return Fault(
        joints=(j,),
        parameters=parameters,
        figures=lambda figures: figures.with_joint(j, **values),
        may_begin=True,
    )


def _logged(
    j: int, channel: str, change: Callable[[Array, np.random.Generator], Array], **figures: float
) -> Fault:
    """One joint's channel is written otherwise."""

    def log(log: Log, rng: np.random.Generator) -> None:
        log[channel][:, j] = change(log[channel][:, j], rng)

    return Fault(joints=(j,), parameters=figures, log=log)


def _has(scene: Scene, name: str, j: int) -> float:
    return float(scene.machine.figures.of(name)[j])


def _rubbing(scene: Scene, low: float, high: float) -> tuple[int, float]:
    """A joint and its level of friction, which is at least a share of the rated torque."""
    j = scene.joint()
    return j, max(_has(scene, "coulomb", j), scene.rated(j, low, high))


def coulomb_friction(scene: Scene) -> Fault:
    """A seal or bearing that rubs."""
    j = scene.joint()
    total = scene.rated(j, 0.12, 0.3) + _has(scene, "coulomb", j)
    return _set(j, {"level": total}, coulomb=total)


def viscous_friction(scene: Scene) -> Fault:
    """Too much grease, or a cold one."""
    j = scene.joint()
    total = scene.rated(j, 0.12, 0.3) + _has(scene, "viscous", j)
    return _set(j, {"coefficient": total}, viscous=total)


def stribeck_friction(scene: Scene) -> Fault:
    """Boundary lubrication."""
    j = scene.joint()
    extra, speed = scene.rated(j, 0.12, 0.25), scene.uniform(0.05, 0.15)
    return _set(j, {"extra": extra, "speed": speed}, stiction=extra, stribeck_speed=speed)


def asymmetric_friction(scene: Scene) -> Fault:
    """A shaft seal or a gear that runs harder one way."""
    j, level = _rubbing(scene, 0.12, 0.2)
    share = scene.sign() * scene.size(0.5, 0.8, 0.95)
    return _set(j, {"level_difference": level * share}, coulomb=level, asymmetry=share)


def load_dependent_friction(scene: Scene) -> Fault:
    """A worn bearing."""
    j, share = scene.loaded(), scene.size(0.2, 0.45, 0.8)
    return _set(j, {"coefficient": share}, load_share=share)


def gear_efficiency(scene: Scene) -> Fault:
    """A gear that loses much, more when it is driven back."""
    j, driving = scene.loaded(), scene.size(0.2, 0.4, 0.8)
    driven = float(f"{driving * scene.rng.uniform(1.4, 2.2):.3g}")
    parameters = {"driving_loss": driving, "driven_loss": driven}
    return _set(j, parameters, loss_driving=driving, loss_driven=driven)


def presliding_hysteresis(scene: Scene) -> Fault:
    """Bearings that wind up before they slide."""
    j, level = _rubbing(scene, 0.12, 0.2)
    reach = scene.size(0.03, 0.09, 0.25)
    return _set(j, {"level": level, "displacement": reach}, coulomb=level, bristle=reach)


def friction_drift(scene: Scene) -> Fault:
    """Viscosity and level that fall as the gear warms: stiff at the start of every recording."""
    j, level = _rubbing(scene, 0.1, 0.2)
    fault = _set(j, {"extra": level}, coulomb=level, warm_level=0.06, warm=0.08)
    return replace(fault, may_begin=False)


def backlash(scene: Scene) -> Fault:
    """Worn teeth, a loose key."""
    j, gap = scene.loaded(), scene.size(0.012, 0.05, 0.15)
    return _set(j, {"gap": gap}, gap=gap)


def joint_elasticity(scene: Scene) -> Fault:
    """A coupling or belt that has gone soft."""
    j = scene.loaded()
    stiffness = float(f"{scene.machine.rated[j] / scene.size(0.03, 0.08):.3g}")
    damping = 0.1 * float(np.sqrt(stiffness * _has(scene, "rotor", j)))
    figures = {"stiffness": stiffness, "hardening": 0.0, "gear_damping": damping}
    return _set(j, {"stiffness": stiffness}, **figures)


def strain_wave_error(scene: Scene) -> Fault:
    """A wave generator out of round, on a gear with a small ratio."""
    j, cycles = scene.joint(), float(scene.rng.choice([16, 24, 32, 60]))
    amplitude = scene.size(1.5e-3, 5e-3, 0.015)
    parameters = {"amplitude": amplitude, "harmonic": cycles}
    return _set(j, parameters, error=amplitude, error_cycles=cycles)


def joint_coupling(scene: Scene) -> Fault:
    """A wrist whose motor also turns with the joint before."""
    j = int(scene.rng.integers(1, scene.n))
    ratio = scene.sign() * scene.size(0.1, 0.25, 0.6)
    return replace(_set(j, {"ratio": ratio}, coupled=ratio), joints=(j - 1, j), may_begin=False)


def torque_gain(scene: Scene) -> Fault:
    """A torque constant from another motor's sheet."""
    j = scene.loaded()
    gain = 1.0 + scene.sign() * scene.size(0.2, 0.35, 0.5)
    return _set(j, {"gain": 1.0 / gain}, gain=gain)


def torque_ripple(scene: Scene) -> Fault:
    """A winding that is weak."""
    j = scene.joint()
    amplitude, cycles = scene.rated(j, 0.1, 0.25), float(scene.rng.choice([3, 6, 8, 12, 20]))
    parameters = {"amplitude": amplitude, "harmonic": cycles}
    return _set(j, parameters, cogging=amplitude, cogging_cycles=cycles)


def torque_saturation(scene: Scene) -> Fault:
    """A limit set too low."""
    j = scene.loaded()
    level = scene.quantile(scene.tau[:, j], 0.8, 0.92) + _has(scene, "coulomb", j)
    return _set(j, {"level": level}, limit=level)


def torque_speed_limit(scene: Scene) -> Fault:
    """A supply with too little voltage."""
    j = scene.loaded()
    stall = float(f"{1.5 * np.max(np.abs(scene.tau[:, j])) + 2.0 * _has(scene, 'coulomb', j):.3g}")
    fastest = float(np.max(np.abs(scene.dq[:, j])))
    no_load = float(f"{fastest * max(0.6, scene.rng.uniform(1.1, 1.4) / scene.severity**0.5):.3g}")
    return _set(j, {"stall_torque": stall, "no_load_speed": no_load}, stall=stall, no_load=no_load)


def command_delay(scene: Scene) -> Fault:
    """A drive behind a slow bus."""
    j, late = scene.joint(), scene.size(0.02, 0.06, 0.15)
    return _set(j, {"delay": late}, delay=late)


def actuator_lag(scene: Scene) -> Fault:
    """A current loop that is badly tuned."""
    j, time = scene.joint(), scene.size(0.012, 0.03, 0.06)
    return _set(j, {"time_constant": time}, lag=time)


def joint_offset(scene: Scene) -> Fault:
    """An encoder mounted askew after a repair."""
    j, offset = scene.loaded(), scene.sign() * scene.size(0.04, 0.12, 0.4)
    return replace(_set(j, {"offset": -offset}, offset=offset), may_begin=False)


def position_dependent_spring(scene: Scene) -> Fault:
    """A hose that is too short."""
    j = scene.joint()
    onset = float(f"{np.quantile(scene.q[:, j], scene.rng.uniform(0.35, 0.65)):.3g}")
    reach = float(np.ptp(scene.q[:, j])) / 2.0 + 0.1
    stiffness, side = float(f"{scene.rated(j, 0.25, 0.5) / reach:.3g}"), scene.sign()
    parameters = {"stiffness": stiffness, "onset": onset, "side": side}
    return _set(j, parameters, spring=stiffness, spring_onset=onset, spring_side=side)


def torque_offset(scene: Scene) -> Fault:
    """A current sensor that shows something at rest."""
    j = scene.joint()
    offset = scene.sign() * scene.rated(j, 0.1, 0.25)
    return _logged(j, "tau", lambda tau, rng: tau + offset, offset=offset)


def sensor_gain(scene: Scene) -> Fault:
    """A speed in a unit that is a little off."""
    j = scene.joint()
    gain = 1.0 + scene.sign() * scene.size(0.1, 0.3, 0.6)
    return _logged(j, "dq", lambda dq, rng: dq * gain, gain=gain)


def sensor_noise(scene: Scene) -> Fault:
    """A cable whose screen is broken."""
    j = scene.joint()
    std = scene.rated(j, 0.08, 0.2)
    return _logged(j, "tau", lambda tau, rng: tau + rng.normal(0.0, std, len(tau)), std=std)


def torque_sign(scene: Scene) -> Fault:
    """A torque of the wrong sign."""
    fault = _logged(scene.loaded(), "tau", lambda tau, rng: -tau, gain=-1.0)
    return replace(fault, effect="sensor_gain")
