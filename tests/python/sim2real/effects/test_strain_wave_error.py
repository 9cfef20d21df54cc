"""A gear whose output runs ahead and behind: torques by inverse dynamics of where the link is."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Estimate, Finding, Model, Simulator, diagnose, predict
from pdoik.sim2real.effects import CATALOGUE, parts_of
from sim2real_effect_studies import ROTORS, Course, named, rubbing, study
from sim2real_robots import ABOUT_PIVOT, TURNTABLE, commands

AMPLITUDE, HARMONIC, PHASE = 1.5e-3, 60.0, 0.7


def waving(course: Course, j: int = 1) -> np.ndarray:
    """Torques of motors whose j-th link is A sin(h q + phase) further than its motor."""
    q, dq, ddq = course.q.copy(), course.dq.copy(), course.ddq.copy()
    angle = HARMONIC * course.q[:, j] + PHASE
    slope = AMPLITUDE * HARMONIC * np.cos(angle)
    bend = -AMPLITUDE * HARMONIC**2 * np.sin(angle)
    q[:, j] += AMPLITUDE * np.sin(angle)
    dq[:, j] *= 1.0 + slope
    ddq[:, j] = (1.0 + slope) * course.ddq[:, j] + bend * course.dq[:, j] ** 2
    load = course.body.dynamics(q, dq, ddq).tau - ROTORS * ddq
    load[:, j] *= 1.0 + slope  # virtual work
    return load + ROTORS * course.ddq


def rippling(course: Course, j: int = 1) -> np.ndarray:
    tau = course.tau.copy()
    tau[:, j] += 0.4 * np.cos(HARMONIC * course.q[:, j] + PHASE)
    return tau


def test_it_is_named_with_the_gears_ratio(tmp_path: Path) -> None:
    diagnosis = diagnose(study(tmp_path, waving))
    assert named(diagnosis, "strain_wave_error") == [("j2",)]
    finding = diagnosis.findings[0]
    assert finding.effect == "strain_wave_error"
    for name, true in (("amplitude", AMPLITUDE), ("harmonic", HARMONIC), ("phase", PHASE)):
        assert finding.values[name] == pytest.approx(true, rel=0.03), name
    for name, true in (("amplitude", AMPLITUDE), ("phase", PHASE)):
        low, high = finding.parameters[name].interval95
        assert low <= true <= high
    assert named(diagnosis, "torque_ripple") == []


def test_a_ripple_of_torque_is_none(tmp_path: Path) -> None:
    diagnosis = diagnose(study(tmp_path, rippling))
    assert named(diagnosis, "strain_wave_error") == []
    assert named(diagnosis, "torque_ripple") == [("j2",)]
    assert diagnosis.findings[0].values["amplitude"] == pytest.approx(0.4, rel=0.03)


def test_plain_friction_is_none(tmp_path: Path) -> None:
    assert named(diagnose(study(tmp_path, rubbing)), "strain_wave_error") == []


@pytest.mark.parametrize("stiffness", [np.inf, 4000.0])
def test_the_simulated_link_is_where_the_gear_puts_it(stiffness: float) -> None:
    """Driven so that the motor turns evenly, the turntable takes what its link's wave needs."""
    values = {"amplitude": AMPLITUDE, "harmonic": HARMONIC, "phase": PHASE}
    found = parts_of("strain_wave_error", ["joint1"], values=values)
    if np.isfinite(stiffness):
        spring = {"stiffness": stiffness, "damping": 2.0}
        found += parts_of("joint_elasticity", ["joint1"], values=spring)
    simulator = Simulator(TURNTABLE, ("joint1",), None, np.array([0.2]), found)
    stepper, speed = simulator.stepper, 1.0
    stepper.timestep = min(1e-3, stepper.laws.longest_step(1e-3))
    stepper.reset(np.zeros(1), np.full(1, speed))
    q, link, taus = [], [], []
    for k in range(round(4.0 / stepper.timestep)):
        aim = speed * k * stepper.timestep
        torque = 4e3 * (aim - stepper.q) + 80.0 * (speed - stepper.dq)
        stepper.step(torque)
        q.append(float(stepper.q[0]))
        T = stepper.tip_pose
        link.append(np.arctan2(T[1, 0], T[0, 0]))
        taus.append(float(torque[0]))
    late = slice(len(q) // 2, None)
    angle = HARMONIC * np.array(q) + PHASE
    error = np.unwrap(np.array(link)) - np.array(q)
    expected = AMPLITUDE * np.sin(angle)
    tolerance = 0.02 if np.isinf(stiffness) else 0.35  # the spring gives, and lags
    assert np.std((error - expected)[late]) < tolerance * np.std(expected)
    if np.isinf(stiffness):
        bend = -AMPLITUDE * HARMONIC**2 * np.sin(angle) * speed**2
        assert np.std(np.array(taus)[late]) > 0.5 * ABOUT_PIVOT * np.std(bend)


def test_a_link_tied_to_its_motor_weighs_as_one_with_it() -> None:
    values = {"amplitude": AMPLITUDE, "harmonic": HARMONIC, "phase": PHASE}
    found = parts_of("strain_wave_error", ["joint1"], values=values)
    plant = Simulator(TURNTABLE, ("joint1",), None, np.array([0.2]), found).stepper.plant
    assert plant.inverse_inertia(np.zeros(1))[0, 0] == pytest.approx(1 / (ABOUT_PIVOT + 0.2))
    assert plant.model.neq == 1
    assert int(plant.model.eq_type[0]) == int(mujoco.mjtEq.mjEQ_JOINT)


def test_its_torque_grows_with_speed_squared() -> None:
    rms = []
    for speed in (0.4, 0.8):
        run = commands(8.0, 2e-3, q=lambda t, v=speed: v * t)
        finding = Finding(
            effect="strain_wave_error",
            joints=("joint1",),
            parameters={
                name: Estimate(value=value, std=0.0, interval95=(value, value), unit="SI")
                for name, value in (("amplitude", 1e-3), ("harmonic", 24.0), ("phase", 0.3))
            },
        )
        model = Model(joints=("joint1",), robot=TURNTABLE, findings=(finding,), cutoff=20.0)
        torque = predict(model, run)[1000:-1000, 0]
        rms.append(float(np.std(torque)))
        bend = 1e-3 * 24.0**2 * speed**2 / np.sqrt(2.0)
        assert rms[-1] == pytest.approx(ABOUT_PIVOT * bend, rel=0.05)
    assert rms[1] == pytest.approx(4.0 * rms[0], rel=0.05)


def test_of_two_names_that_explain_the_same_the_simpler_wins() -> None:
    assert CATALOGUE["strain_wave_error"].complexity > CATALOGUE["torque_ripple"].complexity
