"""The closed-loop simulation against formulas, SciPy's integration and Pinocchio."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytest.importorskip("mujoco", reason="needs the Python package mujoco")

from pdoik.errors import LoadError
from pdoik.sim2real.effects.unknown import VARIABLES
from pdoik.sim2real.recording import Recording
from pdoik.sim2real.simulation import (
    SimulationError,
    Simulator,
    Stepper,
    parts_of,
    unknown_part,
)
from pdoik.sim2real.simulation.of_finding import EFFECTS
from pdoik.sim2real.simulation.parts import JointTorque, Part
from sim2real_robots import (
    ABOUT_PIVOT,
    LENGTH,
    MASS,
    PENDULUM,
    TURNTABLE,
    arm_urdf,
    commands,
    pd,
)

G = 9.81


def parts(effect: str, joint: str = "joint1", **values: float) -> tuple[Part, ...]:
    return parts_of(effect, [joint], values=values)


def free_run(robot: str, q0: float, dq0: float, duration: float, *added: Part) -> Recording:
    """A single joint with no torque, from one recorded state."""
    run = commands(duration, tau_cmd=0.0, q=q0, dq=dq0)
    simulator = Simulator(robot, ["joint1"], parts=added, timestep=1e-3)
    return simulator.replay(run, window=duration)


def unknown(variable: str, lowest: float, highest: float, *values: float) -> tuple[Part, ...]:
    at_knots = {f"value_{k}": value for k, value in enumerate(values)}
    code = float(VARIABLES.index(variable))
    return parts("unknown", variable=code, lowest=lowest, highest=highest, **at_knots)


def swing(
    t: np.ndarray, q0: float, damping: float = 0.0, armature: float = 0.0, friction: float = 0.0
) -> np.ndarray:
    """A pendulum's angle by SciPy: gravity at horizontal angle q pulls with m g l cos q."""

    def rate(_: float, x: np.ndarray) -> list[float]:
        torque = MASS * G * LENGTH * np.cos(x[0]) - damping * x[1]
        torque -= friction * np.tanh(x[1] / 1e-2)
        return [x[1], torque / (ABOUT_PIVOT + armature)]

    solution = solve_ivp(rate, (0, t[-1]), [q0, 0.0], t_eval=t, rtol=1e-10, atol=1e-10)
    return np.asarray(solution.y[0])


@pytest.mark.parametrize(
    ("effect", "values", "expected"),
    [
        ("viscous_friction", {"coefficient": 0.0}, {}),
        ("viscous_friction", {"coefficient": 0.4}, {"damping": 0.4}),
        ("rotor_inertia", {"inertia": 0.1}, {"armature": 0.1}),
    ],
)
def test_a_pendulum_swings_as_scipy_integrates_it(
    effect: str, values: dict[str, float], expected: dict[str, float]
) -> None:
    run = free_run(PENDULUM, 0.3, 0.0, 3.0, *parts(effect, **values))
    # MuJoCo takes damping implicitly, which is exact to first order only.
    tolerance = 2e-3 if "damping" in expected else 1e-5
    assert run.q[:, 0] == pytest.approx(swing(run.time, 0.3, **expected), abs=tolerance)
    assert np.ptp(run.q) > 0.8


def test_dry_friction_slows_a_joint_evenly_and_then_holds_it() -> None:
    level, speed = 0.7, 2.0
    run = free_run(TURNTABLE, 0.0, speed, 1.5, *parts("coulomb_friction", level=level))
    expected = np.maximum(speed - level / ABOUT_PIVOT * run.time, 0.0)
    assert run.dq is not None
    assert run.dq[:, 0] == pytest.approx(expected, abs=2e-3)
    stop = speed * ABOUT_PIVOT / level
    assert np.ptp(run.q[run.time > stop + 0.02]) < 1e-6


def test_a_joint_at_rest_does_not_creep_under_less_torque_than_its_friction() -> None:
    run = commands(2.0, tau_cmd=0.99)
    simulator = Simulator(TURNTABLE, ["joint1"], parts=parts("coulomb_friction", level=1.0))
    assert np.abs(simulator.replay(run, window=2.0).q).max() < 1e-4
    simulator = Simulator(TURNTABLE, ["joint1"], parts=parts("coulomb_friction", level=0.9))
    assert np.abs(simulator.replay(run, window=2.0).q).max() > 0.1


SPEED = 0.8


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(
    ("added", "law"),
    [
        (parts("viscous_friction", coefficient=1.5), lambda t, q, dq: 1.5 * dq),
        (parts("coulomb_friction", level=1.5), lambda t, q, dq: 1.5 * np.sign(dq)),
        (
            parts("coulomb_friction", level=1.0) + parts("stribeck_friction", extra=0.8, speed=1.0),
            lambda t, q, dq: np.sign(dq) * (1.0 + 0.8 * np.exp(-(dq**2))),
        ),
        (
            parts("coulomb_friction", level=1.0)
            + parts("asymmetric_friction", level_difference=0.6, viscous_difference=0.4),
            lambda t, q, dq: np.sign(dq) + 0.3 + 0.2 * np.abs(dq),
        ),
        (
            parts("friction_drift", extra=1.2, time_constant=2.0),
            lambda t, q, dq: 1.2 * np.exp(-t / 2.0) * np.sign(dq),
        ),
        (
            parts("torque_ripple", amplitude=0.5, phase=0.4, harmonic=5.0),
            lambda t, q, dq: 0.5 * np.cos(5.0 * q + 0.4),
        ),
        (
            parts("position_dependent_spring", stiffness=0.7, onset=0.3, side=0),
            lambda t, q, dq: 0.7 * (q - 0.3),
        ),
        (
            parts("position_dependent_spring", stiffness=0.7, onset=0.9, side=1),
            lambda t, q, dq: 0.7 * np.maximum(q - 0.9, 0.0),
        ),
        (
            parts("position_dependent_spring", stiffness=0.7, onset=-0.9, side=-1),
            lambda t, q, dq: 0.7 * np.minimum(q + 0.9, 0.0),
        ),
        (
            parts("presliding_hysteresis", level=1.1, displacement=0.02),
            lambda t, q, dq: 1.1 * np.sign(dq) * (1.0 - np.exp(-np.abs(q) / 0.02)),
        ),
        (
            (unknown_part("joint1", "position", [-1.0, 0.0, 1.0], [0.5, 0.0, 1.0]),),
            lambda t, q, dq: np.interp(q, [-1.0, 0.0, 1.0], [0.5, 0.0, 1.0]),
        ),
        (
            unknown("speed", -1.0, 1.0, 1.0, 0.0, 0.5),
            lambda t, q, dq: np.interp(dq, [-1.0, 0.0, 1.0], [1.0, 0.0, 0.5]),
        ),
        (
            unknown("position and speed", -1.0, 1.0, 0.5, 0.5, 1.0, 0.1, 0.3, 0.1),
            lambda t, q, dq: np.sign(dq) * np.interp(q, [-1.0, 0.0, 1.0], [0.5, 0.5, 1.0])
            + dq * np.interp(q, [-1.0, 0.0, 1.0], [0.1, 0.3, 0.1]),
        ),
        (
            unknown("position and speed", -1.0, 1.0, -0.5, -0.5, 1.0, 0.0, 0.0, 0.0),
            lambda t, q, dq: np.tanh(dq / 0.02) * np.interp(q, [-1.0, 0.0, 1.0], [-0.5, -0.5, 1.0]),
        ),
        (
            unknown("clock", 0.3, 1.0, 0.5, -0.7),
            lambda t, q, dq: 0.5 * np.cos(0.6 * np.pi * t) - 0.7 * np.sin(0.6 * np.pi * t),
        ),
        (
            (JointTorque(joint="joint1", law=lambda t, q, dq, load: q * dq),),
            lambda t, q, dq: q * dq,
        ),
    ],
)  # fmt: skip
def test_a_joint_driven_at_even_speed_needs_the_torque_of_the_law(
    added: tuple[Part, ...], law: Any, direction: float
) -> None:
    acts = law(0.0, 2.0 * direction, 0.5 * direction) != 0.0  # springs with a side: on one only
    run = commands(3.0, q_des=lambda t: direction * SPEED * t, dq_des=direction * SPEED)
    simulator = Simulator(TURNTABLE, ["joint1"], pd(4000.0, 120.0), parts=added)
    result = simulator.replay(run, dq0=np.array([direction * SPEED]))
    assert result.tau is not None
    assert result.dq is not None
    ddq = np.gradient(result.dq[:, 0], run.period)
    settled = result.time > 0.3
    expected = law(result.time, result.q[:, 0], result.dq[:, 0])
    needed = expected + ABOUT_PIVOT * ddq
    assert result.tau[settled, 0] == pytest.approx(needed[settled], abs=0.02)
    assert (np.abs(expected).max() > 0.1) == acts


def test_load_dependent_friction_takes_its_share_of_what_the_gear_transmits() -> None:
    run = commands(2.0, q_des=lambda t: -0.2 * t, dq_des=-0.2)
    added = parts("load_dependent_friction", coefficient=0.2)
    result = Simulator(PENDULUM, ["joint1"], pd(4000.0, 120.0), parts=added).replay(run)
    assert result.tau is not None
    load = -MASS * G * LENGTH * np.cos(result.q[:, 0])  # held against gravity, moving upwards
    settled = result.time > 0.5
    assert result.tau[settled, 0] == pytest.approx(1.2 * load[settled], rel=5e-3)


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


@pytest.mark.parametrize("delay", [0.01, 0.0375])
def test_a_command_delay_shifts_the_motion_by_just_that(delay: float) -> None:
    def wave(t: np.ndarray) -> np.ndarray:
        return 0.3 * np.sin(6 * np.clip(t - 0.2, 0.0, None)) ** 2

    run = commands(2.0, period=5e-4, q_des=wave)
    controller = pd(400.0, 20.0)
    prompt = Simulator(TURNTABLE, ["joint1"], controller, timestep=5e-4).replay(run)
    late = Simulator(
        TURNTABLE, ["joint1"], controller, parts=parts("command_delay", delay=delay), timestep=5e-4
    ).replay(run)
    expected = np.interp(run.time - delay, run.time, prompt.q[:, 0])
    assert late.q[:, 0] == pytest.approx(expected, abs=2e-5)
    assert np.abs(prompt.q - late.q).max() > 5e-3


@pytest.mark.parametrize("effect", ["command_delay", "actuator_lag"])
def test_delays_and_lags_of_the_position_and_of_the_torque_are_not_the_same(effect: str) -> None:
    run = commands(3.0, q_des=lambda t: 0.3 * np.sin(3 * t), dq_des=lambda t: 0.9 * np.cos(3 * t))
    values = {{"command_delay": "delay", "actuator_lag": "time_constant"}[effect]: 0.01}
    of = {
        variant: Simulator(
            TURNTABLE,
            ["joint1"],
            pd(100.0, 8.0),
            parts=parts_of(effect, ["joint1"], values=values, variant=variant),
        ).replay(run)
        for variant in ("position", "torque")
    }
    plain = Simulator(TURNTABLE, ["joint1"], pd(100.0, 8.0)).replay(run)
    assert plain.dq is not None
    settled = plain.time > 0.5
    speed = plain.dq[settled]
    later = {
        variant: float(np.sum(speed * (plain.q - each.q)[settled]) / np.sum(speed**2))
        for variant, each in of.items()
    }
    assert later["torque"] < 0.3 * later["position"]  # the loop makes up for torque that is late
    if effect == "command_delay":
        assert later["position"] == pytest.approx(0.01, abs=1e-3)


def test_a_delayed_torque_command_acts_later() -> None:
    def step(t: np.ndarray) -> np.ndarray:
        return np.where(t >= 0.1 - 1e-9, 1.0, 0.0)

    run = commands(0.5, tau_cmd=step)
    added = parts("command_delay", delay=0.05)
    result = Simulator(TURNTABLE, ["joint1"], parts=added).replay(run, window=0.5)
    assert result.tau is not None
    assert result.time[np.argmax(result.tau[:, 0] > 0.5)] == pytest.approx(0.15, abs=1.1e-3)

    stepper = Stepper(TURNTABLE, ["joint1"], added)
    torques = []
    for u in step(run.time):
        stepper.step([u])
        torques.append(float(stepper.tau[0]))
    assert run.time[int(np.argmax(np.array(torques) > 0.5))] == pytest.approx(0.15, abs=1.1e-3)


def test_a_lagging_drive_answers_a_step_exponentially() -> None:
    run = commands(0.3, tau_cmd=lambda t: np.where(t > 0.0005, 2.0, 0.0))
    added = parts("actuator_lag", time_constant=0.04)
    result = Simulator(TURNTABLE, ["joint1"], parts=added).replay(run, window=0.3)
    since = np.clip(run.time - 1e-3, 0.0, None)  # of the step
    assert result.tau is not None
    assert result.tau[:, 0] == pytest.approx(2.0 * (1 - np.exp(-since / 0.04)), abs=1e-9)
    # What is exerted is what moves it: the integral of the answer.
    speed = 2.0 / ABOUT_PIVOT * (since - 0.04 * (1 - np.exp(-since / 0.04)))
    assert result.dq is not None
    assert result.dq[:, 0] == pytest.approx(speed, abs=1e-9)


def test_a_saturated_drive_gives_no_more_than_its_level() -> None:
    run = commands(1.0, q_des=0.5)
    added = parts("torque_saturation", level=3.0)
    result = Simulator(TURNTABLE, ["joint1"], pd(100.0, 5.0), parts=added).replay(run)
    assert result.tau is not None
    assert result.tau_cmd is not None
    assert np.abs(result.tau).max() == 3.0
    assert np.abs(result.tau_cmd).max() > 40.0
    start = result.time < 0.1
    assert result.q[start, 0] == pytest.approx(
        1.5 / ABOUT_PIVOT * result.time[start] ** 2, abs=1e-9
    )


def test_the_controller_s_own_limit_shows_in_the_command() -> None:
    run = commands(0.5, q_des=0.5)
    controller = pd(100.0, 5.0, torque_limit=np.array([4.0]))
    result = Simulator(TURNTABLE, ["joint1"], controller).replay(run)
    assert result.tau_cmd is not None
    assert np.abs(result.tau_cmd).max() == 4.0


@pytest.mark.parametrize(("gain", "offset"), [(1.25, 0.0), (1.0, 0.6), (0.8, -0.4)])
def test_a_drive_exerts_what_it_reports_less_its_error(gain: float, offset: float) -> None:
    run = commands(3.0, q=0.2, q_des=0.2)
    added = parts("torque_gain", gain=gain) + parts("torque_offset", offset=offset)
    result = Simulator(PENDULUM, ["joint1"], pd(900.0, 40.0), parts=added).replay(run)
    assert result.tau is not None
    true = -MASS * G * LENGTH * np.cos(result.q[-1, 0])
    assert result.tau[-1, 0] == pytest.approx(gain * true + offset, abs=1e-6)
    reported = Simulator(PENDULUM, ["joint1"], parts=added).replay(
        commands(1.0, q=result.q[-1, 0], tau=result.tau[-1, 0]), window=1.0
    )
    assert np.ptp(reported.q) < 1e-4  # what was reported holds it


def test_a_controller_with_a_period_holds_its_torque() -> None:
    run = commands(0.2, q_des=0.5)
    result = Simulator(TURNTABLE, ["joint1"], pd(20.0, 1.0, period=0.01)).replay(run)
    assert result.tau is not None
    changes = np.flatnonzero(np.diff(result.tau[:, 0]))
    assert (np.diff(changes) == 10).all()
    assert len(changes) > 15


def test_encoders_zeros_gains_and_late_logs_are_seen_by_what_reads_them() -> None:
    run = commands(2.0, q_des=lambda t: 0.3 * np.sin(3 * t), dq_des=lambda t: 0.9 * np.cos(3 * t))
    plain = Simulator(TURNTABLE, ["joint1"], pd(900.0, 40.0)).replay(run, tip=True)
    off = Simulator(
        TURNTABLE, ["joint1"], pd(900.0, 40.0), parts=parts("joint_offset", offset=0.1)
    ).replay(run, tip=True)
    assert off.q == pytest.approx(plain.q, abs=1e-9)  # about an upright axis zero is anywhere
    assert off.tip is not None
    yaw = 2 * np.arctan2(off.tip[:, 6], off.tip[:, 3])
    assert yaw == pytest.approx(off.q[:, 0] + 0.1, abs=1e-9)

    skew = parts_of("timestamp_skew", ["joint1"], values={"skew": 0.02}, variant="speed")
    late = Simulator(TURNTABLE, ["joint1"], pd(900.0, 40.0), parts=skew).replay(run)
    assert late.q == pytest.approx(plain.q, abs=0)
    assert late.dq is not None
    assert plain.dq is not None
    assert late.dq[20:] == pytest.approx(plain.dq[:-20], abs=1e-9)

    gain = parts_of("sensor_gain", ["joint1"], values={"gain": 2.0}, variant="torque")
    loud = Simulator(TURNTABLE, ["joint1"], pd(900.0, 40.0), parts=gain).replay(run)
    assert loud.q == pytest.approx(plain.q, abs=0)
    assert loud.tau == pytest.approx(2.0 * np.asarray(plain.tau), abs=1e-12)


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


def test_a_push_at_a_link_is_answered_by_the_joints_while_it_lasts() -> None:
    force, window = np.array([3.0, 0.0, 20.0]), (1.0, 3.0)
    values = dict(zip(("force_x", "force_y", "force_z"), force, strict=True))
    pushed = parts_of("external_contact", [], ["link2"], window, values)
    run = commands(4.0, n=2, q_des=0.0)
    robot, joints = arm_urdf(2), ["joint1", "joint2"]
    result = Simulator(robot, joints, pd(9000.0, 300.0, 2), parts=pushed).replay(run)
    free = Simulator(robot, joints, pd(9000.0, 300.0, 2)).replay(run)
    change = np.asarray(result.tau) - np.asarray(free.tau)
    # link2's origin is 2 LENGTH out along x: about y, r x F = (x, 0, 0) x F has y = -x F_z.
    q1 = result.q[2500, 0]
    lever = 2 * LENGTH * np.array([np.cos(q1), -np.sin(q1)])  # x, z
    moment = lever[1] * force[0] - lever[0] * force[2]
    sag = 9.81 * MASS * LENGTH * 4 * abs(q1 - free.q[2500, 0])
    assert change[2500, 0] == pytest.approx(-moment, abs=sag + 0.05)
    assert change[2500, 1] == pytest.approx(0.0, abs=sag + 0.05)
    assert change[900] == pytest.approx(0.0, abs=1e-9)
    assert change[-1] == pytest.approx(0.0, abs=1e-3)
    elsewhere = parts_of(
        "external_contact", [], ["link2"], window, values, recordings=["other.csv"]
    )
    untouched = Simulator(robot, joints, pd(9000.0, 300.0, 2), parts=elsewhere).replay(run)
    assert untouched.q == pytest.approx(free.q, abs=0)


def test_windows_start_again_from_the_recording() -> None:
    truth = parts("viscous_friction", coefficient=2.0)
    q_des = commands(4.0, q=0.1, q_des=lambda t: 0.1 + 0.5 * np.sin(2 * t))
    recorded = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0), parts=truth).replay(q_des)
    whole = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0)).replay(recorded)
    short = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0)).replay(recorded, window=0.05)
    same = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0), parts=truth).replay(
        recorded, window=0.05
    )
    assert np.abs(short.q - recorded.q).max() < 0.5 * np.abs(whole.q - recorded.q).max()
    assert np.abs(short.q - recorded.q).max() > 1e-4
    assert same.q == pytest.approx(recorded.q, abs=1e-9)
    assert "every 0.05 s" in short.notes[0]


def test_without_a_controller_the_recorded_torque_drives_and_the_notes_say_so() -> None:
    run = commands(2.0, q=0.1, q_des=lambda t: 0.1 + 0.5 * np.sin(2 * t))
    recorded = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0)).replay(run)
    again = Simulator(PENDULUM, ["joint1"]).replay(recorded)
    assert again.q == pytest.approx(recorded.q, abs=1e-3)
    assert "open loop" in again.notes[0]
    assert "every 0.2 s" in again.notes[0]


def test_the_same_commands_give_the_same_motion_to_the_last_bit() -> None:
    run = commands(1.0, n=2, q_des=lambda t: np.stack([np.sin(3 * t), np.cos(2 * t) - 1], axis=1))
    added = (
        *parts("presliding_hysteresis", level=1.0, displacement=0.01),
        *parts("actuator_lag", "joint2", time_constant=0.01),
        *parts("coulomb_friction", "joint2", level=1.0),
    )
    make = lambda: Simulator(arm_urdf(2), ["joint1", "joint2"], pd(300.0, 20.0, 2), parts=added)  # noqa: E731
    simulator = make()
    first, second, third = simulator.replay(run), simulator.replay(run), make().replay(run)
    for other in (second, third):
        assert first.q.tobytes() == other.q.tobytes()
        assert np.asarray(first.tau).tobytes() == np.asarray(other.tau).tobytes()


def test_stepping_by_hand_is_what_a_replay_does() -> None:
    run = commands(1.0, tau_cmd=lambda t: np.sin(5 * t), q=0.2)
    added = (
        *parts("presliding_hysteresis", level=0.5, displacement=0.01),
        *parts("actuator_lag", time_constant=0.01),
    )
    whole = Simulator(PENDULUM, ["joint1"], parts=added).replay(run, window=1.0)
    stepper = Stepper(PENDULUM, ["joint1"], added)
    stepper.reset(run.q[0])
    for k in range(len(run.time) - 1):
        assert run.tau_cmd is not None
        assert stepper.q == pytest.approx(whole.q[k], abs=1e-12)
        stepper.step(run.tau_cmd[k])


def test_every_effect_of_the_table_has_its_parts() -> None:
    values = {
        "coefficient": 0.1, "level": 1.0, "extra": 0.1, "speed": 0.1, "displacement": 0.01,
        "time_constant": 0.01, "inertia": 0.1, "mass": 0.1, "gain": 1.1, "offset": 0.01,
        "amplitude": 0.1, "harmonic": 4.0, "stiffness": 100.0, "delay": 0.01, "gap": 0.01,
        "ratio": 0.1, "skew": 0.01, "std": 0.1, "variable": 1.0,
        "lowest": -1.0, "highest": 1.0, "value_0": 1.0, "value_1": 0.5,
    }  # fmt: skip
    run = commands(0.1, n=2, q_des=0.0)
    for effect in EFFECTS:
        added = parts_of(effect, ["joint1", "joint2"], values=values)
        assert added or effect == "sensor_noise"
        simulator = Simulator(arm_urdf(2), ["joint1", "joint2"], pd(100.0, 10.0, 2), parts=added)
        assert np.isfinite(simulator.replay(run).q).all()


# Misuse


def test_what_cannot_be_replayed_is_said() -> None:
    with pytest.raises(ValueError, match=r"rec.csv: nothing to replay.*no controller"):
        Simulator(PENDULUM, ["joint1"]).replay(commands(1.0, q_des=0.0))
    with pytest.raises(ValueError, match=r"nothing to replay.*got q$"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(commands(1.0))
    gaps = commands(1.0, q_des=lambda t: np.where(t > 0.5, np.nan, 0.0))
    with pytest.raises(ValueError, match=r"q_des.joint1 is needed"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(gaps)
    with pytest.raises(ValueError, match="window must be positive, got -1 s"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(commands(1.0, q_des=0.0), window=-1)
    with pytest.raises(ValueError, match=r"q0 has shape \(2,\), expected \(1,\)"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(
            commands(1.0, q_des=0.0), q0=np.zeros(2)
        )


def test_names_that_are_not_there_are_answered_with_the_nearest() -> None:
    with pytest.raises(ValueError, match="no joint 'joint_1', nearest: 'joint1'"):
        Simulator(PENDULUM, ["joint_1"])
    with pytest.raises(ValueError, match="no link 'lnk1', nearest: 'link1'"):
        Simulator(PENDULUM, ["joint1"], parts=parts_of("payload", [], ["lnk1"], None, {"mass": 1}))
    with pytest.raises(ValueError, match="no effect 'friction'"):
        parts_of("friction", ["joint1"])
    with pytest.raises(ValueError, match="coulomb_friction needs the parameter 'level', got lvl"):
        parts_of("coulomb_friction", ["joint1"], values={"lvl": 1.0})
    with pytest.raises(ValueError, match="torque has 2 entries, the robot has 1 joints"):
        Stepper(PENDULUM, ["joint1"]).step([0.0, 0.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", "not XML"),
        ("<sdf/>", "expected a URDF or an MJCF"),
        ("<mujoco><worldbody><bod/></worldbody></mujoco>", "bod"),
        (PENDULUM.replace(f'mass value="{MASS}"', 'mass value="two"'), "inertial of link link1"),
    ],
)
def test_a_description_that_cannot_be_read_is_a_load_error(text: str, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        Stepper(text, ["joint1"])


def test_links_that_no_body_can_be_are_refused() -> None:
    lost = parts_of("link_inertial_error", [], ["link1"], None, {"d_mass": -3.0})
    with pytest.raises(ValueError, match="link link1: no body has mass -1 kg"):
        Stepper(PENDULUM, ["joint1"], lost)
    massless = '<robot name="r"><link name="a"/><link name="b"/><joint name="joint1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'  # noqa: E501
    with pytest.raises(ValueError, match="joint joint1 moves no inertia: link b has no mass"):
        Stepper(massless, ["joint1"])


def test_a_robot_that_runs_away_is_stopped_with_the_joint_s_name() -> None:
    run = commands(20.0, q_des=0.1)
    away = JointTorque(joint="joint1", law=lambda t, q, dq, load: -50.0 * q - 10.0 * dq)
    with pytest.raises(SimulationError, match="joint joint1 first: its inertia in the model is"):
        Simulator(TURNTABLE, ["joint1"], pd(1.0, 1.0), parts=(away,)).replay(run)


def test_rotors_that_a_model_lacks_are_added_where_the_controller_would_shake_it() -> None:
    run = commands(2.0, q_des=0.1)
    simulator = Simulator(TURNTABLE, ["joint1"], pd(1e4, 1e3, period=0.005))
    result = simulator.replay(run)
    assert result.q[-1, 0] == pytest.approx(0.1, abs=1e-3)
    assert "rotor inertias were added, in kg m^2: 5 of joint1" in result.notes[1]
    soft = Simulator(TURNTABLE, ["joint1"], pd(100.0, 10.0, period=0.001))
    assert len(soft.replay(run).notes) == 1


def test_meshes_that_nobody_has_are_not_needed() -> None:
    mesh = '<visual><geometry><mesh filename="package://no/where.dae"/></geometry></visual>'
    robot = arm_urdf(1, extra=mesh + mesh.replace("visual", "collision"))
    run = commands(0.5, q_des=0.3)
    with_mesh = Simulator(robot, ["joint1"], pd(100.0, 5.0)).replay(run)
    without = Simulator(PENDULUM, ["joint1"], pd(100.0, 5.0)).replay(run)
    assert with_mesh.q == pytest.approx(without.q, abs=0)


MJCF = f"""
<mujoco>
  <compiler angle="degree"/>
  <asset><mesh name="shell" file="no/where.stl"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="link1">
      <inertial pos="{LENGTH} 0 0" mass="{MASS}" diaginertia="0.05 0.05 0.05"/>
      <joint name="joint1" axis="0 1 0" damping="0.3" frictionloss="0.5" armature="0.1"
             range="-10 10" limited="true"/>
      <geom type="mesh" mesh="shell"/>
      <body name="finger"><joint name="slider" type="slide"/><geom size="0.01"/></body>
    </body>
  </worldbody>
  <actuator><position joint="joint1" kp="100"/></actuator>
  <keyframe><key qpos="0 0"/></keyframe>
</mujoco>"""


def test_an_mjcf_gives_its_links_armature_and_friction_and_nothing_else() -> None:
    run = free_run(MJCF, 0.3, 0.0, 2.0)
    expected = swing(run.time, 0.3, 0.3, 0.1, friction=0.5)  # the finger weighs 4 g
    assert run.q[:, 0] == pytest.approx(expected, abs=0.02)
    assert np.ptp(run.q) > 0.8
