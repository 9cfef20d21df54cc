"""Faults of one joint's bearing, gear, drive and encoder."""

from __future__ import annotations

import numpy as np

from bench.sim2real.machines.fault import Fault, Log, Scene


def _set(scene: Scene, kind: str, j: int, parameters: dict[str, float], **values: float) -> Fault:
    """Figures of one joint become others, perhaps in the middle of a recording."""
    return Fault(
        kind=kind,
        effect=kind,
        joints=(j,),
        parameters=parameters,
        figures=lambda figures: figures.with_joint(j, **values),
        may_begin=True,
    )


def _has(scene: Scene, name: str, j: int) -> float:
    return float(scene.machine.figures.of(name)[j])


def coulomb_friction(scene: Scene) -> Fault:
    """A seal or bearing that rubs."""
    j = scene.joint()
    level = scene.rated(j, 0.12, 0.3)
    total = level + _has(scene, "coulomb", j)
    return _set(scene, "coulomb_friction", j, {"level": total}, coulomb=total)


def viscous_friction(scene: Scene) -> Fault:
    """Too much grease, or a cold one."""
    j = scene.joint()
    more = scene.rated(j, 0.12, 0.3)
    total = more + _has(scene, "viscous", j)
    return _set(scene, "viscous_friction", j, {"coefficient": total}, viscous=total)


def stribeck_friction(scene: Scene) -> Fault:
    """Boundary lubrication."""
    j = scene.joint()
    extra, speed = scene.rated(j, 0.12, 0.25), scene.uniform(0.05, 0.15)
    parameters = {"extra": extra, "speed": speed}
    return _set(scene, "stribeck_friction", j, parameters, stiction=extra, stribeck_speed=speed)


def asymmetric_friction(scene: Scene) -> Fault:
    """A shaft seal or a gear that runs harder one way."""
    j = scene.joint()
    level = max(_has(scene, "coulomb", j), scene.rated(j, 0.12, 0.2))
    share = scene.sign() * scene.size(0.5, 0.8, 0.95)
    parameters = {"level_difference": level * share}
    return _set(scene, "asymmetric_friction", j, parameters, coulomb=level, asymmetry=share)


def load_dependent_friction(scene: Scene) -> Fault:
    """A worn bearing."""
    j = scene.loaded()
    share = scene.size(0.2, 0.45, 0.8)
    parameters = {"coefficient": share}
    return _set(scene, "load_dependent_friction", j, parameters, load_share=share)


def gear_efficiency(scene: Scene) -> Fault:
    """A gear that loses much, more when it is driven back."""
    j = scene.loaded()
    driving = scene.size(0.2, 0.4, 0.8)
    driven = float(f"{driving * scene.rng.uniform(1.4, 2.2):.3g}")
    parameters = {"driving_loss": driving, "driven_loss": driven}
    return _set(scene, "gear_efficiency", j, parameters, loss_driving=driving, loss_driven=driven)


def presliding_hysteresis(scene: Scene) -> Fault:
    """Bearings that wind up before they slide."""
    j = scene.joint()
    level = max(_has(scene, "coulomb", j), scene.rated(j, 0.12, 0.2))
    reach = scene.size(0.03, 0.09, 0.25)
    parameters = {"level": level, "displacement": reach}
    return _set(scene, "presliding_hysteresis", j, parameters, coulomb=level, bristle=reach)


def friction_drift(scene: Scene) -> Fault:
    """Viscosity and level that fall as the gear warms: stiff at the start of every recording."""
    j = scene.joint()
    level = max(_has(scene, "coulomb", j), scene.rated(j, 0.1, 0.2))
    parameters = {"extra": level}
    return Fault(
        kind="friction_drift",
        effect="friction_drift",
        joints=(j,),
        parameters=parameters,
        figures=lambda figures: figures.with_joint(j, coulomb=level, warm_level=0.06, warm=0.08),
    )


def backlash(scene: Scene) -> Fault:
    """Worn teeth, a loose key."""
    j = scene.loaded()
    gap = scene.size(0.012, 0.05, 0.15)
    return _set(scene, "backlash", j, {"gap": gap}, gap=gap)


def joint_elasticity(scene: Scene) -> Fault:
    """A coupling or belt that has gone soft."""
    j = scene.loaded()
    stiffness = float(f"{scene.machine.rated[j] / scene.size(0.03, 0.08):.3g}")
    damping = 0.1 * float(np.sqrt(stiffness * _has(scene, "rotor", j)))
    return _set(
        scene,
        "joint_elasticity",
        j,
        {"stiffness": stiffness},
        stiffness=stiffness,
        hardening=0.0,
        gear_damping=damping,
    )


def strain_wave_error(scene: Scene) -> Fault:
    """A wave generator out of round, on a gear with a small ratio."""
    j = scene.joint()
    cycles = float(scene.rng.choice([16, 24, 32, 60]))
    amplitude = scene.size(1.5e-3, 5e-3, 0.015)
    parameters = {"amplitude": amplitude, "harmonic": cycles}
    return _set(scene, "strain_wave_error", j, parameters, error=amplitude, error_cycles=cycles)


def joint_coupling(scene: Scene) -> Fault:
    """A wrist whose motor also turns with the joint before."""
    j = int(scene.rng.integers(1, scene.n))
    ratio = scene.sign() * scene.size(0.1, 0.25, 0.6)
    fault = _set(scene, "joint_coupling", j, {"ratio": ratio}, coupled=ratio)
    return Fault(
        kind=fault.kind,
        effect=fault.effect,
        joints=(j - 1, j),
        parameters=fault.parameters,
        figures=fault.figures,
    )


def torque_gain(scene: Scene) -> Fault:
    """A torque constant from another motor's sheet."""
    j = scene.loaded()
    gain = 1.0 + scene.sign() * scene.size(0.2, 0.35, 0.5)
    return _set(scene, "torque_gain", j, {"gain": 1.0 / gain}, gain=gain)


def torque_ripple(scene: Scene) -> Fault:
    """A winding that is weak."""
    j = scene.joint()
    amplitude, cycles = scene.rated(j, 0.1, 0.25), float(scene.rng.choice([3, 6, 8, 12, 20]))
    parameters = {"amplitude": amplitude, "harmonic": cycles}
    return _set(scene, "torque_ripple", j, parameters, cogging=amplitude, cogging_cycles=cycles)


def torque_saturation(scene: Scene) -> Fault:
    """A limit set too low."""
    j = scene.loaded()
    level = scene.quantile(scene.tau[:, j], 0.8, 0.92)
    level += _has(scene, "coulomb", j)
    return _set(scene, "torque_saturation", j, {"level": level}, limit=level)


def torque_speed_limit(scene: Scene) -> Fault:
    """A supply with too little voltage."""
    j = scene.loaded()
    stall = float(f"{1.5 * np.max(np.abs(scene.tau[:, j])) + 2.0 * _has(scene, 'coulomb', j):.3g}")
    fastest = float(np.max(np.abs(scene.dq[:, j])))
    no_load = float(f"{fastest * max(0.6, scene.rng.uniform(1.1, 1.4) / scene.severity**0.5):.3g}")
    parameters = {"stall_torque": stall, "no_load_speed": no_load}
    return _set(scene, "torque_speed_limit", j, parameters, stall=stall, no_load=no_load)


def command_delay(scene: Scene) -> Fault:
    """A drive behind a slow bus."""
    j, late = scene.joint(), scene.size(0.02, 0.06, 0.15)
    return _set(scene, "command_delay", j, {"delay": late}, delay=late)


def actuator_lag(scene: Scene) -> Fault:
    """A current loop that is badly tuned."""
    j, time = scene.joint(), scene.size(0.012, 0.03, 0.06)
    return _set(scene, "actuator_lag", j, {"time_constant": time}, lag=time)


def joint_offset(scene: Scene) -> Fault:
    """An encoder mounted askew after a repair."""
    j, offset = scene.loaded(), scene.sign() * scene.size(0.04, 0.12, 0.4)
    return Fault(
        kind="joint_offset",
        effect="joint_offset",
        joints=(j,),
        parameters={"offset": -offset},
        figures=lambda figures: figures.with_joint(j, offset=offset),
    )


def position_dependent_spring(scene: Scene) -> Fault:
    """A hose that is too short."""
    j = scene.joint()
    onset = float(f"{np.quantile(scene.q[:, j], scene.rng.uniform(0.35, 0.65)):.3g}")
    reach = float(np.ptp(scene.q[:, j])) / 2.0 + 0.1
    stiffness, side = float(f"{scene.rated(j, 0.25, 0.5) / reach:.3g}"), scene.sign()
    parameters = {"stiffness": stiffness, "onset": onset, "side": side}
    return _set(
        scene,
        "position_dependent_spring",
        j,
        parameters,
        spring=stiffness,
        spring_onset=onset,
        spring_side=side,
    )


def torque_offset(scene: Scene) -> Fault:
    """A current sensor that shows something at rest."""
    j = scene.joint()
    offset = scene.sign() * scene.rated(j, 0.1, 0.25)

    def change(log: Log, rng: np.random.Generator) -> None:
        log["tau"][:, j] += offset

    return Fault(
        kind="torque_offset",
        effect="torque_offset",
        joints=(j,),
        parameters={"offset": offset},
        log=change,
    )


def sensor_gain(scene: Scene) -> Fault:
    """A speed in a unit that is a little off."""
    j = scene.joint()
    gain = 1.0 + scene.sign() * scene.size(0.1, 0.3, 0.6)

    def change(log: Log, rng: np.random.Generator) -> None:
        log["dq"][:, j] *= gain

    return Fault(
        kind="sensor_gain",
        effect="sensor_gain",
        joints=(j,),
        parameters={"gain": gain},
        log=change,
    )


def sensor_noise(scene: Scene) -> Fault:
    """A cable whose screen is broken."""
    j = scene.joint()
    std = scene.rated(j, 0.08, 0.2)

    def change(log: Log, rng: np.random.Generator) -> None:
        log["tau"][:, j] += rng.normal(0.0, std, len(log["tau"]))

    return Fault(
        kind="sensor_noise",
        effect="sensor_noise",
        joints=(j,),
        parameters={"std": std},
        log=change,
    )


def torque_sign(scene: Scene) -> Fault:
    """A torque of the wrong sign."""
    j = scene.loaded()

    def change(log: Log, rng: np.random.Generator) -> None:
        log["tau"][:, j] *= -1.0

    return Fault(
        kind="torque_sign",
        effect="sensor_gain",
        joints=(j,),
        parameters={"gain": -1.0},
        log=change,
    )
