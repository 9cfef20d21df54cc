"""Simulated springs, play and couplings between motors and links."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytest.importorskip("mujoco", reason="needs the Python package mujoco")

from pdoik.sim2real.effects import parts_of
from pdoik.sim2real.simulation import Simulator
from sim2real_robots import (
    ABOUT_PIVOT,
    LENGTH,
    MASS,
    PENDULUM,
    TURNTABLE,
    G,
    arm_urdf,
    commands,
    parts,
    pd,
)


@pytest.mark.parametrize("stiffness", [200.0, 5000.0])
def test_motor_and_link_swing_against_each_other_as_two_inertias(stiffness: float) -> None:
    motor, kick = 0.1, 1.0
    run = commands(0.5, tau_cmd=0.0, dq=kick)
    added = parts("joint_elasticity", stiffness=stiffness, damping=0.0)
    simulator = Simulator(TURNTABLE, ["joint1"], None, np.array([motor]), added, timestep=1e-4)
    result = simulator.replay(run, window=0.5)
    # The motor starts with a speed, the link at rest relative to it: both move together; so give
    # the link another speed by hand and let SciPy do the same.
    assert result.q[:, 0] == pytest.approx(kick * run.time, abs=1e-9)

    stepper = simulator.stepper
    stepper.reset()
    motor_dof, play = stepper.plant.dof[0], stepper.plant.play[0]
    stepper.data.qvel[motor_dof], stepper.data.qvel[play] = kick, -kick
    stepper.data.qpos[:] = 0.5 * stepper.timestep * stepper.data.qvel

    def rate(_: float, x: np.ndarray) -> list[float]:
        twist = stiffness * (x[1] - x[0])
        return [x[2], x[3], twist / motor, -twist / ABOUT_PIVOT]

    times = stepper.timestep * np.arange(1, 1001)
    angles = []
    for _ in times:
        stepper.step([0.0])
        angles.append(float(stepper.q[0]))
    solution = solve_ivp(rate, (0, 1), [0, 0, kick, 0], t_eval=times, rtol=1e-9, atol=1e-12)
    assert np.array(angles) == pytest.approx(solution.y[0], abs=2e-3 * np.ptp(solution.y[0]))
    omega = np.sqrt(stiffness * (1 / motor + 1 / ABOUT_PIVOT))
    assert omega * times[-1] > 2  # it did swing


def test_a_spring_stiffer_than_any_step_is_as_good_as_rigid_and_said() -> None:
    run = commands(2.0, q_des=lambda t: 0.3 * np.sin(4 * t))
    controller, rotor = pd(400.0, 20.0, period=1e-3), np.array([0.1])
    added = parts("joint_elasticity", stiffness=1e9, damping=0.0)
    stiff = Simulator(PENDULUM, ["joint1"], controller, rotor, added).replay(run)
    rigid = Simulator(PENDULUM, ["joint1"], controller, rotor).replay(run)
    assert stiff.q == pytest.approx(rigid.q, abs=1e-3)
    assert "the stiffest that steps of 0.0001 s follow, not 1e+09" in stiff.notes[1]


def test_a_motor_behind_play_is_given_an_inertia_where_none_is_known() -> None:
    simulator = Simulator(PENDULUM, ["joint1"], parts=parts("backlash", gap=0.01))
    assert f"its motor is given 10% of the link's, {0.1 * ABOUT_PIVOT:.3g}" in simulator.notes[0]


@pytest.mark.parametrize("gap", [1e-3, 2e-2])
def test_a_hanging_link_lies_at_alternate_ends_of_the_play(gap: float) -> None:
    hang = np.pi / 2
    run = commands(8.0, period=4e-3, q=hang, q_des=lambda t: hang + 0.5 * np.sin(np.pi * t / 4))
    controller = pd(2000.0, 80.0, gravity_compensation=True)
    simulator = Simulator(
        PENDULUM, ["joint1"], controller, np.array([0.05]), parts("backlash", gap=gap)
    )
    result = simulator.replay(run, tip=True)
    assert result.tip is not None
    angle = 2 * np.arctan2(result.tip[:, 5], result.tip[:, 3])  # about y
    play = np.unwrap(angle) - result.q[:, 0]
    at_top = [int(np.argmax(result.q[:, 0])), int(np.argmin(result.q[:, 0]))]
    # Gravity pulls towards hanging: behind the motor on either side.
    assert play[at_top[1]] - play[at_top[0]] == pytest.approx(gap, rel=0.05)
    assert np.ptp(play) < 1.1 * gap


def test_a_coupled_joint_turns_with_the_other_motor_and_loads_it() -> None:
    ratio, target = 0.4, np.array([0.3, 0.5])
    run = commands(4.0, n=2, q=target, q_des=target)
    coupled = parts_of("joint_coupling", ["joint2", "joint1"], values={"ratio": ratio})
    result = Simulator(
        arm_urdf(2), ["joint1", "joint2"], pd(3000.0, 100.0, 2), parts=coupled
    ).replay(run, tip=True)
    assert result.tip is not None
    assert result.tau is not None
    q1, q2 = result.q[-1] @ np.array([[1.0, ratio], [0.0, 1.0]])
    pitch = 2 * np.arctan2(result.tip[-1, 5], result.tip[-1, 3])
    assert pitch == pytest.approx(q1 + q2, abs=1e-6)
    moment2 = -MASS * G * LENGTH * np.cos(q1 + q2)
    moment1 = moment2 - 3 * MASS * G * LENGTH * np.cos(q1)
    assert result.tau[-1] == pytest.approx([moment1 + ratio * moment2, moment2], rel=1e-4)
